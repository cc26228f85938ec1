"""Heat flux at a Pitot pressure of the facility: what meets a measured pair, carried on to others."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from plasmapyro import tables
from plasmapyro.checks import positive, within
from plasmapyro.gas.species import AIR

RATES = ("kossyi", "park")
NOSES = (0.005, 0.0125, 0.025)  # [m]
RECOMBINATION = (0.01, 0.1, 1.0)
MASS_FLOW = 0.016  # [kg s-1] of the jets of the table
RADIUS = 0.025  # [m]: hemisphere whose heat flux the table holds
RADII = (0.002, 0.1)  # [m] of calorimeters that may be asked for
SLOW = 0.1  # of the chamber pressure: a Pitot pressure at Mach 0.4; beyond, density follows the speed
LEAST_PITOT = 1.0  # [Pa]; the least of a computed jet is 5
ENDS = (0.025, 0.5, 0.975)
QUANTITIES = ("heat_flux", "temperature", "enthalpy", "speed", "numerical_power")
GASES = {"air": AIR["N2"], "N2": 1.0}  # mole fraction of N2 in the cold gas
AXES = ("pressure", "mixing", "power")
LEAST_SHARE = 0.05  # of the draws that must meet the pair
PAIR_PRESSURE = 5000.0  # [Pa] of the chamber at which the pairs were measured
MIDDLE = 0.01  # recombination that lets pass half of what meets a copper wall at 50 mbar, in Goulard's form
FINE = 25  # mixing lengths between which lines at one Pitot pressure are straight
LESS_GAS = np.array([0.25, 0.0, 0.0, 0.5, 0.5])  # powers of the Pitot pressure at a given enthalpy
CARRIED = 0.08  # relative uncertainty of a heat flux between jets that are carried over; see `carried_over`
FADED = 2.6  # times the Pitot pressure of the pair, where the mixing may have faded; see docs/plasmatron.md


def scale(recombination):
    """Measure of a recombination [1] in which the heat flux is nearly straight: gamma / (gamma + 0.01)."""
    return np.asarray(recombination) / (np.asarray(recombination) + MIDDLE)


@dataclass(frozen=True)
class Explanations:
    """Draws (d,): recombination of the calorimeter, index in `RATES`, radius of the Pitot nose [m], and where
    a jet with less gas lies between those of least power (0) and of the next (1); NaN: there is none."""

    recombination: np.ndarray
    rates: np.ndarray
    nose: np.ndarray
    warmth: float | np.ndarray = np.nan


@dataclass(frozen=True)
class Jets:
    """Jets by chamber pressure, mixing and rising power; logarithms of SI.

    `pitot` (p, m, w, nose); `state` (p, m, w, 4): temperature, enthalpy, speed, power; `flux` (rates, p, m,
    w, recombination); `computed` (p, m, w), False where carried over from another pressure or mixing.
    """

    pressure: np.ndarray
    mixing: np.ndarray
    pitot: np.ndarray
    state: np.ndarray
    flux: np.ndarray
    computed: np.ndarray

    def at(self, pitot, pressure, explanations):
        r"""Jets in which a Pitot probe reads `pitot`, for each mixing length of the table.

        Straight lines in the logarithms of Pitot pressure, static pressure and nose, above the most power
        straight on; in the recombination as :math:`\gamma/(\gamma + 0.01)`. Where jets of 16 g/s read more
        at any power (the cold gas alone does), the jet has less gas at the same enthalpy: with s the root of
        the ratio of both readings, its power and speed are s times, its heat flux :math:`\sqrt s` times that
        of a jet between the two of least power.

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
            Between computed flows.
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
        mean = weights(np.log(pressure), np.log(self.pressure))
        read = np.einsum("p,dk,pmwk->dmw", mean, weights(nose, np.log(NOSES)), self.pitot)
        flux = np.einsum("p,dk,dpmwk->dmw", mean, weights(gamma, scale(RECOMBINATION)), self.flux[e.rates])
        state = np.broadcast_to(np.einsum("p,pmwq->mwq", mean, self.state), (*flux.shape, 4))
        columns = np.concatenate([flux[..., None], state], axis=-1)  # (d, m, w, 5)
        goal = np.log(np.broadcast_to(pitot, (len(nose), np.shape(pitot)[-1])))[:, None, :]

        least = read.argmin(axis=-1, keepdims=True)  # (d, m, 1); from there on the reading rises with power
        rising = np.where(np.arange(read.shape[-1]) < least, -np.inf, read)
        segment = (goal[..., None] > rising[..., None, :]).sum(axis=-1) - 1
        segment = np.clip(segment, np.minimum(least, read.shape[-1] - 2), read.shape[-1] - 2)
        low, high = (np.take_along_axis(read, segment + step, axis=-1) for step in (0, 1))
        share = ((goal - low) / (high - low))[..., None]
        ends = [np.take_along_axis(columns, segment[..., None] + step, axis=-2) for step in (0, 1)]
        values = (1 - share) * ends[0] + share * ends[1]

        floor = np.take_along_axis(read, least, axis=-1)
        warmth = np.broadcast_to(e.warmth, len(nose))[:, None, None, None]
        coldest = (1 - warmth) * columns[:, :, :1]
        coldest = coldest + warmth * np.take_along_axis(columns, np.maximum(least, 1)[..., None], axis=-2)
        below = (goal < floor)[..., None]
        values = np.where(below, coldest + LESS_GAS * (goal - floor)[..., None], values)
        done = self.computed[mean > 0].all(axis=0)  # (m, w)
        m = np.arange(len(done))[:, None]
        inside = done[m, segment] & done[m, segment + 1]
        return values, inside & ~below[..., 0] & (goal <= read[..., -1:])


@cache
def jets(gas="air"):
    """The Jets in a gas of the data table 'facility/jets', on a finer grid of mixing lengths."""
    table = tables.load("facility/jets")
    axes = [np.unique(table[name]) for name in ("pressure", "mixing", "power")]
    pitot = [f"pitot_{1e3 * nose:g}_mm" for nose in NOSES]
    flux = [f"flux_{rates}_{gamma}" for rates in RATES for gamma in ("0.01", "0.1")]
    state = ["temperature", "enthalpy", "speed", "power"]
    names = [*pitot, *state, *flux, "flux_equilibrium"]
    values = np.full((len(GASES), *map(len, axes), len(names)), np.nan)
    place = tuple(np.searchsorted(axis, table[axis_of]) for axis, axis_of in zip(axes, AXES, strict=True))
    kinds = list(GASES)
    kind = np.array([kinds.index(one) for one in table["gas"]])
    values[kind, *place] = np.log(np.stack([table[name] for name in names], axis=-1))
    values[..., names.index("power")] = np.log(axes[2])
    computed = np.isfinite(values[..., 0])
    base = int(np.searchsorted(axes[0], PAIR_PRESSURE))
    for k, (own, done) in enumerate(zip(values, computed, strict=True)):  # other gases follow air
        if done.any():
            own[base] = carried_over(own[base], done[base], values[0, base] if k else None)
        for p in range(len(own)):
            own[p] = (
                carried_over(own[p], done[p], own[base])
                if done[p].any()
                else values[0, p] + own[base] - values[0, base]
            )
    values, computed = values[kinds.index(gas)], computed[kinds.index(gas)]
    pressure, mixing = axes[:2]
    fine = np.linspace(mixing[0], mixing[-1], FINE)
    share = weights(fine, mixing)
    values = np.einsum("fm,pmwk->pfwk", share, values)
    computed = np.einsum("fm,pmw->pfw", (share > 0) * 1, ~computed * 1) == 0
    first = len(pitot) + len(state)
    flux = np.stack([values[..., [first + 2 * k, first + 2 * k + 1, -1]] for k in range(len(RATES))])
    return Jets(pressure, fine, values[..., : len(pitot)], values[..., len(pitot) : first], flux, computed)


def carried_over(values, computed, model=None):
    """Logarithms (m, w, k) with the jets that were not computed.

    Their ratios to the nearest jet computed are those of `model`, jets at another pressure or in another gas.
    Without it the ratio of two powers is that of the next mixing. From one of the nine jets at 100 mbar the
    others follow within 14 % of Pitot pressure, 13 % of heat flux and 3 % of temperature.
    """
    values, known = values.copy(), np.argwhere(computed)
    for m, w in np.argwhere(~computed):
        if model is None:
            other = min(known[known[:, 1] == w, 0], key=lambda one, m=m: abs(one - m))
            near = np.flatnonzero(computed[m] & computed[other])
            near = min(near, key=lambda one, w=w: abs(one - w))
            values[m, w] = values[other, w] + values[m, near] - values[other, near]
        else:
            one = tuple(known[np.abs(known - (m, w)).sum(axis=1).argmin()])
            values[m, w] = model[m, w] + values[one] - model[one]
    return values


def needed_mixing(explanations, heat_flux, pitot):
    """Mixing length over the torch radius [1] with which jets of air at 50 mbar give heat fluxes [W m-2] at
    Pitot pressures [Pa]: (d,).

    NaN where a jet of 16 g/s would have to give more than without mixing, or less than with the most that
    still lets a probe read so little.
    """
    count = len(explanations.nose)
    values, _ = jets().at(np.broadcast_to(pitot, count)[:, None], PAIR_PRESSURE, explanations)
    goal, found = np.log(np.broadcast_to(heat_flux, count)), np.full(count, np.nan)
    for k, flux in enumerate(values[:, ::-1, 0, 0]):
        known = np.isfinite(flux)
        if known.any() and flux[known][0] <= goal[k] <= flux[-1]:
            found[k] = np.interp(goal[k], flux[known], jets().mixing[::-1][known])
    return found


def predict(
    pitot, pressure, *, pair, recombination, nose, flux_uncertainty, pressure_uncertainty, mixing_spread,
    draws, seed, radius=RADIUS, shape="hemisphere", gas="air",
):  # fmt: skip
    r"""What a cold calorimeter reads where a Pitot probe reads so much, and the jet there.

    Each draw takes a recombination and a Pitot nose (uniform in the logarithm between their ends), a set of
    rates, and a heat flux and pressure of the measured pair within their uncertainties. The mixing length C
    that meets the pair is kept below its Pitot pressure; above, where other measurements ask for less, it
    falls by a share s, uniform from 0 to 1, until 2.6 times that pressure:

    .. math:: C(p) = C\,\Big(1 - s\,\frac{\ln(p/p_{pair})}{\ln 2.6}\Big)

    Draws that no mixing length meets are left out. Both new readings are as uncertain as those of the pair:
    next to what 16 g/s read at any power, an error of 5 % of the Pitot pressure is half the heat flux.

    Parameters
    ----------
    pitot : sequence of float [Pa]
        Above the chamber pressure, at most a tenth of it.
    pressure : float [Pa]
        Of the chamber; 2500 to 20000.
    pair : str
        Of the data table 'facility/plasmatron_pairs'.
    recombination : pair of float [1]
        Least and largest of the calorimeter, 0.01 to 1.
    nose : pair of float [m]
        Least and largest radius of the Pitot nose, 0.005 to 0.025.
    flux_uncertainty, pressure_uncertainty : float [1]
        Relative standard uncertainties of the pair, and of both readings asked for.
    draws, seed : int
    radius : float [m]
        Of the calorimeter; its `shape` as in `probes.Calorimeter`. Another than the hemisphere of 25 mm takes
        the ratio of both on the stagnation line in the median jet.
    gas : str
        'air' or 'N2', of the jet; the pair is air, and its mixing and recombination are taken for both.

    Returns
    -------
    dict
        Of each of `QUANTITIES` the 2.5, 50 and 97.5 % quantiles, (3, n) in SI; those of `mixing` (3,) at the
        pair; `inside` (n,), share of the draws between the computed flows; `explained`, share that meets the
        pair; `share` (n,) of what the hemisphere of 25 mm takes.

    Raises
    ------
    ValueError
        An unknown pair or gas, an argument out of range, or a pair that hardly any draw meets.
    """
    pitot = positive("pitot", np.atleast_1d(np.asarray(pitot, dtype=float)), "Pa")
    if pitot.max() > SLOW * pressure:
        raise ValueError(
            f"the Pitot pressure must lie below {SLOW * pressure:g} Pa, {SLOW:g} of that of the chamber,"
            f" where the gas is slow against sound; got {pitot.max():g} Pa"
        )
    if pitot.min() < LEAST_PITOT:
        raise ValueError(
            f"the Pitot pressure must be {LEAST_PITOT:g} Pa or more: less asks for under half of the 16 g/s"
            f" that jets were computed with; got {pitot.min():g} Pa (1 mbar is 100 Pa)"
        )
    within("radius of the calorimeter", radius, *RADII, "m")
    for name, (low, high) in (("recombination", recombination), ("radii of the Pitot nose", nose)):
        if not low <= high:
            raise ValueError(f"{name}: the least comes first, then the largest; got {low:g} and {high:g}")
    known = [one for one in GASES if one in tables.load("facility/jets")["gas"]]
    if gas not in known:
        raise ValueError(f"no jets in '{gas}'; computed in: {', '.join(known)}")
    table = tables.load("facility/plasmatron_pairs")
    if pair not in table["pair"]:
        raise ValueError(f"no pair '{pair}'; known: {', '.join(table['pair'])}")
    row = list(table["pair"]).index(pair)
    read = table["dynamic_pressure"][row]
    random = np.random.default_rng(seed)
    gamma, radii = (np.exp(random.uniform(*np.log(ends), draws)) for ends in (recombination, nose))
    drawn = Explanations(gamma, random.integers(len(RATES), size=draws), radii)
    flux = table["heat_flux"][row] * np.exp(flux_uncertainty * random.standard_normal(draws))
    faded, warmth = random.uniform(size=(2, draws))
    mixing = needed_mixing(drawn, flux, read * np.exp(pressure_uncertainty * random.standard_normal(draws)))
    met = np.isfinite(mixing)
    if met.mean() < LEAST_SHARE:
        raise ValueError(
            f"only {met.sum()} of {draws} draws meet the pair '{pair}'; widen what is admissible"
        )
    drawn = Explanations(gamma[met], drawn.rates[met], radii[met], warmth[met])
    own = pitot * np.exp(pressure_uncertainty * random.standard_normal((met.sum(), len(pitot))))
    beyond = np.clip(np.log(own / read) / np.log(FADED), 0.0, 1.0)
    another = np.exp(mixing_spread * random.standard_normal(own.shape))
    there = mixing[met, None] * (1 - faded[met, None] * beyond) * another  # (d, n)
    there = np.minimum(there, jets(gas).mixing[-1])
    values, inside = jets(gas).at(own, pressure, drawn)
    values[..., 0] += CARRIED * random.standard_normal(own.shape)[:, None] * ~inside
    values[..., 0] += flux_uncertainty * random.standard_normal(own.shape)[:, None]
    share = weights(there, jets(gas).mixing)  # (d, n, m)
    ends = np.exp(np.quantile(np.einsum("dnm,dmnq->dnq", share, values), ENDS, axis=0))
    result = {name: ends[..., k] for k, name in enumerate(QUANTITIES)}
    result["share"] = np.ones(len(pitot))
    if (radius, shape) != (RADIUS, "hemisphere"):
        middle = float(np.sqrt(np.prod(recombination)))
        states = zip(result["temperature"][1], result["speed"][1], strict=True)
        wall = radius, shape, middle, pressure
        result["share"] = np.array([_other(*wall, *state, GASES[gas]) for state in states])
        result["heat_flux"] *= result["share"]
    return {
        **result,
        "mixing": np.quantile(mixing[met], ENDS),
        "inside": np.einsum("dnm,dmn->n", share, inside) / met.sum(),
        "explained": float(met.mean()),
    }


def _other(radius, shape, recombination, pressure, temperature, speed, nitrogen):
    """Heat flux of another calorimeter over that of the hemisphere of 25 mm."""
    from plasmapyro.facility.jet import Jet  # needs Cantera, which a light installation lacks
    from plasmapyro.facility.probes import Calorimeter, heat_flux

    jet = Jet(float(temperature), float(pressure), float(speed), 0.0, nitrogen)
    one, standard = (
        heat_flux(jet, Calorimeter(*probe, recombination=recombination), "kossyi")[0]
        for probe in ((radius, shape), (RADIUS, "hemisphere"))
    )
    return one / standard


def weights(x, known):
    """Weights (..., k) of rising known points in a linear interpolation at x (...)."""
    x, known = np.asarray(x, dtype=float), np.asarray(known, dtype=float)
    k = np.clip(np.searchsorted(known, x) - 1, 0, len(known) - 2)
    share = (x - known[k]) / (known[k + 1] - known[k])
    steps = np.arange(len(known))
    return np.where(steps == k[..., None], (1 - share)[..., None], 0.0) + np.where(
        steps == k[..., None] + 1, share[..., None], 0.0
    )
