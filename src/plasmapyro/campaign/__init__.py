"""A campaign: what several tests of one laboratory say together about what they share."""
