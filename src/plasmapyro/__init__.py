"""Two-colour pyrometry through a radiating plasma: from torch flow to corrected surface temperature."""
