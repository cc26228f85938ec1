"""Files of priors, as `plasmapyro campaign` writes them."""

from plasmapyro import configuration
from plasmapyro.campaign.stage import law_of_priors

HELP = "what earlier tests say of instruments, emittance and power: priors.yaml of `plasmapyro campaign`"


def read_priors(path):
    """`Normal` law of a file priors.yaml, or None without a path.

    Raises
    ------
    ValueError
        What is wrong with the file.
    """
    return law_of_priors(configuration.read(path), path) if path else None
