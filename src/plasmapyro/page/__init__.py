"""The page of a diagnosis: one file that explains itself, from the files of the diagnosis alone."""

import jinja2


def templates(package):
    """The templates beside the modules of a package; they escape what they are given, and miss nothing."""
    return jinja2.Environment(
        loader=jinja2.PackageLoader(package, "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
