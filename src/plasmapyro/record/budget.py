"""The uncertainty budget of a temperature: what each input adds, from the estimate that knows its slopes."""

from typing import NamedTuple

import numpy as np

NORMAL_95 = 1.959964  # standard deviations of half a 95 % interval
GROUPS = ("noise", "calibration", "emittance", "gas", "named effects", "unnamed misfit")
PLACES = 4  # moments of a test at which a budget is written out


class Input(NamedTuple):
    """An input with an uncertainty, and what that adds to the temperature.

    `contribution` (t,) [K] is sensitivity times uncertainty, with a sign where one number errs; the standard
    `uncertainty` in `unit` is NaN for what has no single number; `freedom` inf where it is stated.
    """

    name: str
    group: str
    contribution: np.ndarray
    uncertainty: float = np.nan
    unit: str = ""
    law: str = "normal"
    freedom: float = np.inf


def variables(inputs, axis="time"):
    r"""The budget of inputs, independent of each other, as variables of a dataset, with their dimension
    `axis`.

    .. math:: u_c^2(T) = \sum_i \left(\frac{\partial T}{\partial x_i}\right)^2 u^2(x_i)

    Source: JCGM 100:2008, eq. 10 and the table of H.1.
    """
    rows = np.stack([one.contribution for one in inputs])
    return {
        "input_quantity": ("input_quantity", np.array([one.name for one in inputs], dtype=object)),
        "input_group": ("input_quantity", np.array([one.group for one in inputs], dtype=object)),
        "input_unit": ("input_quantity", np.array([one.unit for one in inputs], dtype=object)),
        "input_law": ("input_quantity", np.array([one.law for one in inputs], dtype=object)),
        "input_uncertainty": ("input_quantity", np.array([one.uncertainty for one in inputs])),
        "input_freedom": ("input_quantity", np.array([one.freedom for one in inputs])),
        "temperature_contribution": (("input_quantity", axis), rows),
    }


def inputs_of(dataset):
    """The inputs of a dataset that holds the variables of a budget."""
    columns = [dataset[name].values for name in ("input_quantity", "input_group", "temperature_contribution")]
    rest = [dataset[f"input_{name}"].values for name in ("uncertainty", "unit", "law", "freedom")]
    return [Input(*row) for row in zip(*columns, *rest, strict=True)]


def combined(inputs):
    """Combined standard uncertainty (t,) [K], the root of the summed squares."""
    return np.sqrt(sum(one.contribution**2 for one in inputs))


def of_family(name, group, covariance, sigmas, unit="", law="normal"):
    r"""An input of one or more numbers with priors, from their covariance with the temperature.

    .. math:: \frac{\partial T}{\partial x_i} = \frac{\mathrm{cov}(T, \theta_i)}{\sigma_i^2}

    is how the estimate moves with what is stated of number i, so :math:`\mathrm{cov}(T, \theta_i)/\sigma_i`
    is what the uncertainty of that statement adds.

    Source: linear Gaussian estimation. With the posterior covariance :math:`C = (J^T W J + P)^{-1}`, and P
    diagonal for the numbers with priors, :math:`C = C J^T W J C + C P C`: noise first, then each prior.

    Parameters
    ----------
    covariance : (t, n) array [K times the unit], of the posterior
    sigmas : (n,) array, standard deviations of the prior
    """
    parts = covariance / sigmas
    single = parts.shape[1] == 1
    whole = parts[:, 0] if single else np.sqrt(np.sum(parts**2, axis=1))
    return Input(name, group, whole, float(np.sqrt(np.mean(np.square(sigmas)))), unit, law)


def remainder(variance, inputs):
    """Contribution (t,) [K] of all that is not among the inputs, from the whole variance (t,)."""
    return np.sqrt(np.maximum(variance - sum(one.contribution**2 for one in inputs), 0.0))


def by_group(dataset):
    """Contributions {group: (t,) array [K]} of a dataset with a budget, of groups that it has."""
    rows, groups = dataset.temperature_contribution.values, dataset.input_group.values
    return {group: np.sqrt(np.sum(rows[groups == group] ** 2, axis=0)) for group in GROUPS if group in groups}


def freedom(inputs, place):
    r"""Effective degrees of freedom at a place of the series.

    .. math:: \nu_{eff} = u_c^4 \Big/ \sum_i u_i^4 / \nu_i

    Source: Welch-Satterthwaite, JCGM 100:2008, eq. G.2b.
    """
    total = combined(inputs)[place] ** 4
    parts = sum(one.contribution[place] ** 4 / one.freedom for one in inputs)
    return float(total / parts) if parts > 0 else np.inf


def moments(temperature):
    """Places of a series (t,) [K] at which a budget is told: first, hottest, last, and one while it heats."""
    good = np.flatnonzero(np.isfinite(temperature))
    if not good.size:
        return []
    hottest = good[np.argmax(temperature[good])]
    heating = good[good <= hottest]
    steps = np.linspace(temperature[good[0]], temperature[hottest], PLACES - 1)
    chosen = [good[0], hottest, good[-1]]
    chosen += [heating[np.argmin(np.abs(temperature[heating] - kelvin))] for kelvin in steps[1:-1]]
    return sorted({int(place) for place in chosen})
