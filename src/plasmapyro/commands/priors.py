"""Files of priors, as `plasmapyro campaign` writes them."""

from pathlib import Path

import numpy as np

import plasmapyro.campaign
from plasmapyro import configuration
from plasmapyro.diagnosis.fit.prior import POWER, Normal

SCHEMA = Path(plasmapyro.campaign.__file__).with_name("priors.schema.yaml")
# Logarithms that such a file holds; emittance, 0.8, or a power in kilowatt are none of them.
LOGARITHMS = {"emittance": (np.log(0.01), 0.1, "the emittance"), POWER: (np.log(1e3), np.log(1e8), "watts")}


def read_priors(path, digests=None):
    """`Normal` law of a file priors.yaml, or None without a path.

    ValueError says what is wrong with the file: keys, names, lengths, units, a correlation that is none, or
    calibrations that are not those of its tests (`digests`: file -> sha256, those it is to be used with).
    """
    if not path:
        return None
    values = configuration.load(path, SCHEMA)
    for name, known in values.get("calibrations", {}).items():
        if (digests or {}).get(name, known) != known:
            raise ValueError(
                f"{path}: its tests ({', '.join(values['tests'])}) were measured with another {name}; what a"
                " campaign says of instruments ends with their calibration: make one of tests of this one"
            )
    names, rows = values["names"], [values["mean"], values["sigma"], *values["correlation"]]
    if {len(row) for row in rows} != {len(names)} or len(rows) != len(names) + 2:
        raise ValueError(f"{path}: mean and sigma need a number for each name, correlation a row")
    mean, sigma, correlation = (np.array(values[key], float) for key in ("mean", "sigma", "correlation"))
    for name, number in zip(names, mean, strict=True):
        low, high, what = LOGARITHMS.get(name, (-np.inf, np.inf, ""))
        if not low <= number <= high:
            raise ValueError(
                f"{path}: the mean of {name} is the logarithm of {what}, from {low:.3g} to {high:.3g};"
                f" got {number:g}"
            )
    covariance = correlation * np.outer(sigma, sigma)
    if not np.isfinite(covariance).all() or not np.isfinite(mean).all():
        raise ValueError(f"{path}: mean, sigma and correlation must be finite")
    sound = np.allclose(correlation, correlation.T) and np.allclose(np.diag(correlation), 1.0)
    if not sound or np.linalg.eigvalsh((correlation + correlation.T) / 2)[0] <= 0:
        raise ValueError(
            f"{path}: correlation must be symmetric, 1 on its diagonal, with positive eigenvalues"
        )
    return Normal(tuple(names), mean, (covariance + covariance.T) / 2)
