"""Flow fields of other programs: files in, sight line out; and our own flow as a file that others read."""

FILES = ("file", "mesh")


def map_of(condition):
    """The map of a condition that brings its own flow field: its key `cfd` without the files."""
    return {key: value for key, value in condition["cfd"].items() if key not in FILES}
