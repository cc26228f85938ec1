"""Heat flux at a Pitot pressure of the facility: what meets a measured pair, carried on to others."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from plasmapyro import tables
from plasmapyro.checks import positive, within

RATES = ("kossyi", "park")
NOSES = (0.005, 0.0125, 0.025)  # [m]
RECOMBINATION = (0.01, 0.1, 1.0)
RADIUS = 0.025  # [m]: hemisphere whose heat flux the table holds
ENDS = (0.025, 0.5, 0.975)
QUANTITIES = ("heat_flux", "temperature", "enthalpy", "speed", "numerical_power")
LEAST_SHARE = 0.05  # of the draws that must meet the pair
PAIR_PRESSURE = 5000.0  # [Pa] of the chamber at which the pairs were measured
MIDDLE = 0.01  # recombination that lets pass half of what meets a copper wall at 50 mbar, in Goulard's form
FADED = 2.6  # times the Pitot pressure of the pair, where the mixing may have faded; see docs/plasmatron.md


def scale(recombination):
    """Measure of a recombination [1] in which the heat flux is nearly straight: gamma / (gamma + 0.01)."""
    return np.asarray(recombination) / (np.asarray(recombination) + MIDDLE)


@dataclass(frozen=True)
class Explanations:
    """Draws (d,): recombination of the calorimeter, index in `RATES`, and radius of the Pitot nose [m]."""

    recombination: np.ndarray
    rates: np.ndarray
    nose: np.ndarray


@dataclass(frozen=True)
class Jets:
    """Computed jets by chamber pressure, mixing and rising power; logarithms of SI.

    `pitot` (p, m, w, nose); `state` (p, m, w, 4): temperature, enthalpy, speed, power; `flux`
    (rates, p, m, w, recombination).
    """

    pressure: np.ndarray
    mixing: np.ndarray
    pitot: np.ndarray
    state: np.ndarray
    flux: np.ndarray

    def at(self, pitot, pressure, explanations):
        r"""Jets in which a Pitot probe reads `pitot`, for each mixing length of the table.

        Straight lines in the logarithms of Pitot pressure, static pressure and nose, and beyond the computed
        flows straight on; in the recombination as :math:`\gamma/(\gamma + 0.01)`.

        Parameters
        ----------
        pitot : (n,) or (d, n) array [Pa]
        pressure : float [Pa]
            Of the chamber.
        explanations : Explanations

        Returns
        -------
        values : (d, m, n, 5) array
            Logarithms of `QUANTITIES` [SI].
        inside : (d, m, n) bool array
            Between the computed flows.
        """
        e = explanations
        nose = np.log(within("pitot radius", e.nose, NOSES[0], NOSES[-1], "m"))
        gamma = scale(within("recombination", e.recombination, RECOMBINATION[0], 1.0, "1"))
        if not self.pressure[0] <= pressure <= self.pressure[-1]:
            ends = " to ".join(f"{one / 100:g}" for one in self.pressure[[0, -1]])
            raise ValueError(
                f"chamber pressure must lie in {ends} mbar, where jets were computed; got"
                f" {pressure / 100:g} mbar: compute a condition there, with `measured:`"
            )
        read = np.einsum("dk,pmwk->dpmw", _weights(nose, np.log(NOSES)), self.pitot)
        flux = np.einsum("dk,dpmwk->dpmw", _weights(gamma, scale(RECOMBINATION)), self.flux[e.rates])
        columns = np.broadcast_to(self.state, (*flux.shape, 4))
        columns = np.concatenate([flux[..., None], columns], axis=-1)  # (d, p, m, w, 5)
        goal = np.log(np.broadcast_to(pitot, (len(nose), np.shape(pitot)[-1])))[:, None, None, :]
        last = read.shape[-1] - 2
        segment = np.clip((goal[..., None] > read[..., None, :]).sum(axis=-1) - 1, 0, last)
        low, high = (np.take_along_axis(read, segment + step, axis=-1) for step in (0, 1))
        share = ((goal - low) / (high - low))[..., None]
        ends = [np.take_along_axis(columns, segment[..., None] + step, axis=-2) for step in (0, 1)]
        values = (1 - share) * ends[0] + share * ends[1]
        inside = (goal >= read[..., :1]) & (goal <= read[..., -1:])
        mean = _weights(np.log([pressure]), np.log(self.pressure))[0]
        return np.einsum("p,dpmnq->dmnq", mean, values), inside[:, mean > 0].all(axis=1)


@cache
def jets():
    """The Jets of the data table 'facility/jets'."""
    table = tables.load("facility/jets")
    pressure, mixing, power = (np.unique(table[name]) for name in ("pressure", "mixing", "power"))
    shape = (len(pressure), len(mixing), len(power))

    def logarithms(*names):
        return np.log(np.stack([table[name].reshape(shape) for name in names], axis=-1))

    pitot = [f"pitot_{1e3 * nose:g}_mm" for nose in NOSES]
    flux = [logarithms(f"flux_{rates}_0.01", f"flux_{rates}_0.1", "flux_equilibrium") for rates in RATES]
    state = logarithms("temperature", "enthalpy", "speed", "power")
    return Jets(pressure, mixing, logarithms(*pitot), state, np.stack(flux))


def needed_mixing(explanations, heat_flux, pitot):
    """Mixing length over the torch radius [1] with which jets at 50 mbar give heat fluxes [W m-2] at Pitot
    pressures [Pa], and the temperature of their gas [K]: arrays (d,).

    NaN where a jet would have to give more than without mixing, or less than with the most of the table.
    """
    count = len(explanations.nose)
    values, _ = jets().at(np.broadcast_to(pitot, count)[:, None], PAIR_PRESSURE, explanations)
    goal = np.log(np.broadcast_to(heat_flux, count))
    found = np.full((2, count), np.nan)
    for k, (flux, kelvin) in enumerate(zip(values[:, ::-1, 0, 0], values[:, ::-1, 0, 1], strict=True)):
        if flux[0] <= goal[k] <= flux[-1]:
            found[:, k] = [np.interp(goal[k], flux, one) for one in (jets().mixing[::-1], np.exp(kelvin))]
    return found


def predict(
    pitot, pressure, *, pair, recombination, nose, flux_uncertainty, pressure_uncertainty, draws, seed,
    radius=RADIUS, shape="hemisphere",
):  # fmt: skip
    r"""What a cold calorimeter takes where a Pitot probe reads so much, and the jet there.

    Each draw takes a recombination and a Pitot nose (uniform in the logarithm between their ends), a set of
    rates, and a heat flux and pressure of the measured pair within their uncertainties. The mixing length C
    that meets the pair is kept below its Pitot pressure; above, where other measurements ask for less, it
    falls by a share s, uniform from 0 to 1, until 2.6 times that pressure:

    .. math:: C(p) = C\,\Big(1 - s\,\frac{\ln(p/p_{pair})}{\ln 2.6}\Big)

    Draws that no mixing length meets are left out.

    Parameters
    ----------
    pitot : sequence of float [Pa]
        Above the chamber pressure.
    pressure : float [Pa]
        Of the chamber; 5000 to 10000.
    pair : str
        Of the data table 'facility/plasmatron_pairs'.
    recombination : pair of float [1]
        Least and largest of the calorimeter, 0.01 to 1.
    nose : pair of float [m]
        Least and largest radius of the Pitot nose, 0.005 to 0.025.
    flux_uncertainty, pressure_uncertainty : float [1]
        Relative standard uncertainties of the pair.
    draws, seed : int
    radius : float [m]
        Of the calorimeter; its `shape` as in `probes.Calorimeter`. Another than the hemisphere of 25 mm takes
        the ratio of both on the stagnation line in the median jet.

    Returns
    -------
    dict
        Of each of `QUANTITIES` the 2.5, 50 and 97.5 % quantiles, (3, n) in SI; those of `mixing` (3,) at the
        pair; `inside` (n,), share of the draws between the computed flows; `explained`, share that meets the
        pair.

    Raises
    ------
    ValueError
        An unknown pair, an argument out of range, or a pair that hardly any draw meets.
    """
    pitot = positive("pitot", np.atleast_1d(np.asarray(pitot, dtype=float)), "Pa")
    table = tables.load("facility/plasmatron_pairs")
    if pair not in table["pair"]:
        raise ValueError(f"no pair '{pair}'; known: {', '.join(table['pair'])}")
    row = list(table["pair"]).index(pair)
    read = table["dynamic_pressure"][row]
    random = np.random.default_rng(seed)
    gamma, radii = (np.exp(random.uniform(*np.log(ends), draws)) for ends in (recombination, nose))
    drawn = Explanations(gamma, random.integers(len(RATES), size=draws), radii)
    flux = table["heat_flux"][row] * np.exp(flux_uncertainty * random.standard_normal(draws))
    faded = random.uniform(size=draws)
    mixing, _ = needed_mixing(
        drawn, flux, read * np.exp(pressure_uncertainty * random.standard_normal(draws))
    )
    met = np.isfinite(mixing)
    if met.mean() < LEAST_SHARE:
        raise ValueError(
            f"only {met.sum()} of {draws} draws meet the pair '{pair}'; widen what is admissible"
        )
    drawn = Explanations(*(values[met] for values in vars(drawn).values()))
    beyond = np.clip(np.log(pitot / read) / np.log(FADED), 0.0, 1.0)
    there = mixing[met, None] * (1 - faded[met, None] * beyond)  # (d, n)
    values, inside = jets().at(pitot, pressure, drawn)
    share = _weights(there, jets().mixing)  # (d, n, m)
    ends = np.exp(np.quantile(np.einsum("dnm,dmnq->dnq", share, values), ENDS, axis=0))
    result = {name: ends[..., k] for k, name in enumerate(QUANTITIES)}
    if (radius, shape) != (RADIUS, "hemisphere"):
        middle = float(np.sqrt(np.prod(recombination)))
        states = zip(result["temperature"][1], result["speed"][1], strict=True)
        result["heat_flux"] *= [_other(radius, shape, middle, pressure, *state) for state in states]
    return {
        **result,
        "mixing": np.quantile(mixing[met], ENDS),
        "inside": np.einsum("dnm,dmn->n", share, inside) / met.sum(),
        "explained": float(met.mean()),
    }


def _other(radius, shape, recombination, pressure, temperature, speed):
    """Heat flux of another calorimeter over that of the hemisphere of 25 mm."""
    from plasmapyro.facility.jet import Jet  # needs Cantera, which a light installation lacks
    from plasmapyro.facility.probes import Calorimeter, heat_flux

    jet = Jet(float(temperature), float(pressure), float(speed), 0.0)
    one, standard = (
        heat_flux(jet, Calorimeter(*probe, recombination=recombination), "kossyi")[0]
        for probe in ((radius, shape), (RADIUS, "hemisphere"))
    )
    return one / standard


def _weights(x, known):
    """Weights (..., k) of rising known points in a linear interpolation at x (...)."""
    x, known = np.asarray(x, dtype=float), np.asarray(known, dtype=float)
    k = np.clip(np.searchsorted(known, x) - 1, 0, len(known) - 2)
    share = (x - known[k]) / (known[k + 1] - known[k])
    steps = np.arange(len(known))
    return np.where(steps == k[..., None], (1 - share)[..., None], 0.0) + np.where(
        steps == k[..., None] + 1, share[..., None], 0.0
    )
