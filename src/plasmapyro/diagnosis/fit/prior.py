"""What tests of one laboratory share: out of a fit as a normal law, and back into a model as its prior."""

from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.diagnosis.fit.model import Model
from plasmapyro.diagnosis.fit.persistent import scale_at, scale_ends

SHARED = (
    "emittance",
    "gain_pyrometer",
    "gain_spectrometer",
    "ratio",
    "lamp",
    "edge_wide",
    "edge_narrow",
    "tail",
)
POWER = "power"
SMOOTH = "smooth_spectrometer"


@dataclass(frozen=True)
class Normal:
    """A normal law of named numbers: `mean` (d,) and `covariance` (d, d).

    `emittance` and `power` [W] are logarithms; all others are as the base model has them, 0 for an
    instrument as it is stated.
    """

    names: tuple
    mean: np.ndarray
    covariance: np.ndarray

    @property
    def sigma(self):
        """Standard deviations (d,)."""
        return np.sqrt(np.diag(self.covariance))

    def of(self, names):
        """The law of some of the numbers."""
        at = [self.names.index(name) for name in names]
        return Normal(tuple(names), self.mean[at], self.covariance[np.ix_(at, at)])

    def moved(self, by):
        """The same law with constants {name: value} added to its numbers."""
        return replace(self, mean=self.mean + [by.get(name, 0.0) for name in self.names])

    def wider(self, name, sigma):
        """The same law, one of its numbers with an independent error more."""
        at = np.array([one == name for one in self.names])
        return replace(self, covariance=self.covariance + np.diag(at * sigma**2))

    def beside(self, other):
        """This law and an independent one as one."""
        total = np.zeros((len(self.names) + len(other.names),) * 2)
        first = len(self.names)
        total[:first, :first], total[first:, first:] = self.covariance, other.covariance
        return Normal((*self.names, *other.names), np.append(self.mean, other.mean), total)


def shared_rows(model):
    """Names of what a model shares with other tests, and the rows (d, V) that give it from its parameters.

    The scale of a spectrometer stands at as many wavelengths as it has modes: what fewer leave open would
    count as new in each test of a campaign.
    """
    kinds = {one.kind for one in model.instruments}
    names, rows = [], []
    for name in SHARED:
        place = model.index.get(name)
        if place is not None and model.parameters[place].instrument in (None, *kinds):
            names.append(name)
            rows.append(np.eye(1, len(model.parameters), place)[0])
    for instrument, errors, place in zip(model.instruments, model.persistent, model.places, strict=True):
        smooth = np.array([one.id == SMOOTH for one in errors.parameters])
        if not smooth.any():
            continue
        axis = instrument.wavelength
        points = np.round(np.linspace(*scale_ends(axis), smooth.sum()), 9)
        for point, modes in zip(
            points, scale_at(points, axis, errors.channel[:, smooth], errors.lengths), strict=True
        ):
            row = np.zeros(len(model.parameters))
            row[place][smooth] = modes
            names.append(f"scale_{point * 1e9:.0f}")
            rows.append(row)
    return tuple(names), np.array(rows)


def prior_of(model):
    """`Normal` law of what a model shares, before its data; relative to what its test states."""
    names, rows = shared_rows(model)
    centre = np.array([one.centre for one in model.parameters])
    return Normal(names, rows @ centre, rows @ np.linalg.solve(model.precision, rows.T))


def posterior_of(model, solution):
    """`Normal` law of what a model shares, after a fit; relative to what its test states."""
    names, rows = shared_rows(model)
    own = slice(model.size, model.size + len(model.parameters))
    return Normal(names, rows @ solution.state.values, rows @ solution.covariance[own, own] @ rows.T)


def stated(model):
    """What a test states {name: logarithm} of the numbers that a `Normal` holds as such."""
    found = {"emittance": float(np.log(model.emittance)), POWER: float(np.log(model.library.power))}
    return {name: value for name, value in found.items() if np.isfinite(value)}


def relative(known, model):
    """A law of numbers as one relative to what the test of a model states.

    Between the bands a slope of this sample's emittance and an error of the ratio are the same, where it is
    no number of its own.
    """
    at_hand, record = stated(model), model.record
    names = [name for name in known.names if name not in ("emittance", POWER) or name in at_hand]
    law = known.of(names).moved({name: -value for name, value in at_hand.items()})
    if "emittance_slope" in model.index:
        return law
    return law.wider("ratio", record.emittance_slope_uncertainty / record.emittance_slope)


def with_prior(model, known):
    r"""The model with another prior of what it shares with other tests.

    .. math:: p(\theta) \to p(\theta)\,\frac{q(L\theta)}{p(L\theta)}

    Parameters
    ----------
    model : Model
    known : Normal
        The law q, relative to what the test states; `power` is that of the gas. Names that the model does
        not have are left out.

    Returns
    -------
    Model
    """
    names, rows = shared_rows(model)
    both = [name for name in names if name in known.names]
    rows = rows[[names.index(name) for name in both]]
    new, old = known.of(both), prior_of(model).of(both)
    centre = np.array([one.centre for one in model.parameters])
    precision = (
        model.precision + rows.T @ (np.linalg.inv(new.covariance) - np.linalg.inv(old.covariance)) @ rows
    )
    pull = model.precision @ centre + rows.T @ (
        np.linalg.solve(new.covariance, new.mean) - np.linalg.solve(old.covariance, old.mean)
    )
    precision = (precision + precision.T) / 2
    centre, sigma = np.linalg.solve(precision, pull), np.sqrt(np.diag(np.linalg.inv(precision)))
    parameters = [
        replace(one, centre=float(c), sigma=float(s))
        for one, c, s in zip(model.parameters, centre, sigma, strict=True)
    ]
    power = model.power
    if POWER in known.names:
        one = known.of([POWER])
        power = float(one.mean[0]), float(one.sigma[0])
    return Model(
        model.instruments,
        model.library,
        model.history,
        parameters[: len(model.own)],
        model.record,
        model.slope,
        model.response,
        model.lamp,
        [
            replace(errors, parameters=tuple(parameters[place]))
            for errors, place in zip(model.persistent, model.places, strict=True)
        ],
        model.given,
        precision=precision,
        power=power,
    )
