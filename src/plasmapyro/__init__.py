"""Two-colour pyrometry through a radiating plasma: from torch flow to corrected surface temperature."""


def __getattr__(name: str) -> str:
    """`__version__`, looked up when it is asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("plasmapyro")
    raise AttributeError(f"module 'plasmapyro' has no attribute {name!r}")
