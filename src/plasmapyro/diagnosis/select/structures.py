"""Structures that no effect describes: walks, waves, patterns, smooth maps, single lines, channels, codes."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.diagnosis.effects.instrument import clocks_apart
from plasmapyro.diagnosis.fit.base import phase_of
from plasmapyro.diagnosis.fit.noise import slope_of
from plasmapyro.diagnosis.fit.observation import line_shapes
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.select.excursion import EXCURSION
from plasmapyro.radiation.bandsignal import BANDS
from plasmapyro.record.phases import during

SMOOTH_MAP = "smooth"  # id of the class that has two axes
GAS_OF_TIME = {"zero", "moment"}  # what adds light for a time: more of a gas's, in the mean
MAP_WAVES = 8
WALK_STEPS = 40
ZERO = 0.01  # [1], of the usual signal: unit of a zero that wanders
MOVED = (-4.0, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, 4.0)  # [s] by which a clock may be off
NEAR_END = 8.0  # [s]
CLOCK = 10.0  # [s]: unit of a clock that does
SHORTEST_PERIOD = 24.0  # [s]; the bins of the steady state are 8 s long
GROWTH = 12.0  # of matter that a hot surface releases, at 1600 K


@dataclass(frozen=True)
class Structure:
    """A class of unknown structures: its columns, all at once or one of them, to be scaled by `SCALES`.

    With `basis` (columns, b) one of b combinations of them stands for a single column.
    """

    id: str
    name: str
    columns: slice
    single: bool = False
    basis: np.ndarray | None = None


class _Products:
    """Columns of one instrument as rows (n, C) times shares (n,): few rows, many columns."""

    def __init__(self, shape):
        self.shape, self.rows, self.shares, self.size = shape, [], [], 0

    def row(self, values):
        """A row (n, C) to be shared; its number."""
        self.rows.append(np.broadcast_to(values, self.shape))
        return len(self.rows) - 1

    def add(self, size, *parts):
        """`size` columns: the sum of rows times shares over (number of a row, shares (n, size))."""
        self.shares.append((slice(self.size, self.size + size), parts))
        self.size += size

    def whole(self):
        """Rows (n, C, r) and shares (n, r, m)."""
        shares = np.zeros((self.shape[0], len(self.rows), self.size))
        for place, parts in self.shares:
            for number, own in parts:
                shares[:, number, place] += own
        return np.stack(self.rows, axis=2), shares


class _Classes:
    """Classes of structures as they are found, their columns one after the other."""

    def __init__(self, instruments):
        self.products = [_Products(instrument.value.shape) for instrument in instruments]
        self.found, self.total = [], 0

    def add(self, identity, name, size):
        """A class of so many columns."""
        self.found.append(Structure(identity, name, slice(self.total, self.total + size)))
        self.total += size
        return self.found[-1]

    def add_products(self, identity, name, parts):
        """A class from {place of an instrument: [(number of a row, shares (n, m)), ...]}."""
        size = next(iter(parts.values()))[0][1].shape[1]
        for place, products in enumerate(self.products):
            products.add(size, *parts.get(place, ()))
        self.add(identity, name, size)


def seen_by(identity):
    """{"instrument", "axis"} of a class of structures by its id."""
    words = set(identity.split("_"))
    if "heat" in words and "spectrometer" in words:
        return {"instrument": "spectrometer", "axis": "temperature"}
    if "heat" in words:
        return {"instrument": "pyrometer", "axis": "time and temperature"}
    if "signal" in words:
        return {"instrument": "pyrometer", "axis": "signal"}
    if "both" in words or {"gas", "walk"} <= words:
        return {"instrument": "both", "axis": "time"}
    if words & {"pyrometer", "ratio", "wide", "narrow", "clock"}:
        return {"instrument": "pyrometer", "axis": "time"}
    if words & {"walk", "wave", "moment", "frames", "step"}:
        return {"instrument": "spectrometer", "axis": "time"}
    if words & {"surface", "released"}:
        return {"instrument": "spectrometer", "axis": "wavelength and temperature"}
    if identity == SMOOTH_MAP or "left" in words:  # a pattern that comes and goes
        return {"instrument": "spectrometer", "axis": "time and wavelength"}
    return {"instrument": "spectrometer", "axis": "wavelength"}


def may_be_gas(identity):
    """Whether what lies behind a class of structures changes the spectrum of the gas that was measured: no
    pyrometer does, nor a gain of the spectrometer that changes in time or with the heat of the surface."""
    seen = seen_by(identity)
    if identity == EXCURSION:
        return False
    gain = seen["instrument"] == "spectrometer" and seen["axis"] in ("time", "temperature")
    return seen["instrument"] != "pyrometer" and (not gain or bool(GAS_OF_TIME & {*identity.split("_")}))


def multiplies(identity):
    """Whether a class of patterns multiplies light: others add some."""
    return not {"gas", "released"} & {*identity.split("_")}


def structures_of(model, solution, steps=WALK_STEPS):
    """Unknown structures: columns per instrument as products, patterns over the channels, and their classes.

    Smooth over time and wavelength; a pattern over the channels that multiplies everything, the surface, or
    adds to the gas (always, or as a hot surface releases it); random walks of the gain of each instrument, of
    the ratio of the bands and of each band, of their zeros and of their clock; gains of the bands that come
    and go along the signal.

    Returns
    -------
    classes : tuple of Structure, whose columns count from the first product; patterns follow
    products : list of (rows (n, C, r), shares (n, r, m)): the columns `rows @ shares`
    patterns : list of (instrument, row (n, C)): one column per channel, the row at that channel
    """
    classes, patterns, gas_rows, smooth = _Classes(model.instruments), [], [], {}
    fitted = zip(model.instruments, classes.products, solution.prediction, solution.gas, strict=True)
    for place, (instrument, products, value, gas) in enumerate(fitted):
        time = instrument.time
        walk, wave = _walk(time, model.off, steps), _waves(time, model.off)
        gas_rows.append(products.row(gas))
        if instrument.kind == "spectrometer":
            gain, name = products.row(value), "gain of the spectrometer"
            classes.add_products("walk_spectrometer", f"wandering {name}", {place: [(gain, walk)]})
            classes.add_products("wave_spectrometer", f"periodic {name}", {place: [(gain, wave)]})
            zero = products.row(instrument.factor * ZERO * np.nanmedian(value / instrument.factor))
            classes.add_products(
                "walk_zero_spectrometer", "wandering zero of the spectrometer", {place: [(zero, walk)]}
            )
            heat = _heat(model, solution, time)
            tilts = [products.row(value * (instrument.wavelength / PIVOT) ** power) for power in TILTS]
            parts = [(row, np.kron(one, heat)) for row, one in zip(tilts, np.eye(len(tilts)), strict=True)]
            classes.add_products("heat_spectrometer", f"{name} that follows the surface", {place: parts})
            patterns += [(place, *row) for row in _spectral_patterns(model, solution, time, value, gas)]
        else:
            bands = [products.row(value * one) for one in np.eye(instrument.channels)]
            kinds = tuple(classes_of_bands(instrument.band, instrument.source))
            _add_bands(classes, place, bands, walk, wave, kinds)
            warming = _heat(model, solution, time)[:, None] * _settling(time, 0.0, model.off)[..., None]
            warming = warming.reshape(time.size, -1)
            for (identity, name, signs), band in zip(kinds[-instrument.channels :], bands, strict=True):
                name_of_heat = f"{name} that warms, as the surface does"
                classes.add_products(f"heat_{identity}", name_of_heat, {place: [(band, warming)]})
                zero = products.row(signs * ZERO * np.nanmedian(value, axis=0))
                classes.add_products(
                    f"walk_zero_{identity}", f"wandering zero of the {name}", {place: [(zero, walk)]}
                )
            surface = np.where(time[:, None] >= 0, value - gas, 0.0)
            tick = products.row(CLOCK * slope_of(surface, time, phase_of(time, model.off)))
            classes.add_products(
                "walk_clock", f"wandering clock of the {instrument.source}", {place: [(tick, walk)]}
            )
            late, shares = _late(model, solution, place, value, len(walk[0]))
            parts = [(products.row(row), share) for row, share in zip(late, shares, strict=True)]
            parts.append((tick, np.hstack([walk, np.zeros((time.size, len(MOVED)))])))
            classes.add_products(
                "end_clock", f"clock of the {instrument.source} from a moment on", {place: parts}
            )
            _add_codes(classes, place, bands, value, kinds)
        if instrument.weight is None:
            waves = zip(*_smooth(model, instrument), strict=True)
            smooth[place] = [(products.row(value * wave), shares) for wave, shares in waves]
    walks = _common_walk(model.instruments, model.off)
    brightness = {place: [pair] for place, pair in enumerate(zip(gas_rows, walks, strict=True))}
    classes.add_products("walk_gas", "wandering brightness of the gas", brightness)
    if smooth:
        classes.add_products(SMOOTH_MAP, "smooth map over time and wavelength", smooth)
    spectral = [(place, classes.add(identity, name, row.shape[1])) for place, identity, name, row in patterns]
    structures = [one for one in classes.found if not one.id.startswith(("wave", "walk_gas", "heat"))]
    structures += _singles(model, classes.found, spectral, steps)
    products = [products.whole() for products in classes.products]
    return tuple(structures), products, [(place, row) for place, _, _, row in patterns]


def classes_of_bands(names, source):
    """(id, name, signs) of gains of bands: together, against each other where they are two, apart where they
    are several."""
    each = np.eye(len(names))
    yield "pyrometer", f"gain of the {source}", np.ones(len(names))
    if len(names) == 1:
        return
    if len(names) == 2:
        yield "ratio", f"ratio of the {source}", (1.0, -1.0)
    for name, signs in zip(names, each, strict=True):
        word = f"{name} band" if tuple(names) == BANDS else f"band {name}"
        yield name if tuple(names) == BANDS else f"pyrometer_{name}", f"{word} of the {source}", signs


def _add_bands(classes, place, bands, walk, wave, kinds):
    """Wandering and periodic gains of the bands, together, apart and against each other."""
    for identity, name, signs in kinds:
        for kind, word, steps in (("walk", "wandering", walk), ("wave", "periodic", wave)):
            if kind == "walk" or identity in WAVING:
                parts = [(band, sign * steps) for band, sign in zip(bands, signs, strict=True)]
                classes.add_products(f"{kind}_{identity}", f"{word} {name}", {place: parts})


def _add_codes(classes, place, bands, value, kinds):
    """Gains of the bands along their signals (n, C): of each, and of all where one converter reads them, or
    amplifiers change their ranges together, by the first."""
    codes, each = [_codes(signal) for signal in value.T], kinds[-len(bands) :]
    for (identity, name, _), band, gains, signal in zip(each, bands, codes, value.T, strict=True):
        parts = [(band, np.hstack([gains, _ranges(signal)]))]
        classes.add_products(f"signal_{identity}", f"gain of the {name}", {place: parts})
    if len(bands) > 1:
        steps = _ranges(value[:, 0])
        parts = [(band, np.hstack([gains, steps])) for band, gains in zip(bands, codes, strict=True)]
        classes.add_products("signal_pyrometer", kinds[0][1], {place: parts})


def _singles(model, found, spectral, steps):
    """Structures of one column: a step, a wave, a channel, a line, fringes."""
    singles, courses = [], {}
    for instrument in model.instruments:
        courses[instrument.kind] = _courses(instrument.time, model.off, steps)
    for one in found:
        kind, last = one.id.split("_")[0], one.id.split("_")[-1]
        if kind in SINGLE_NAMES:
            whose = "spectrometer" if last == "spectrometer" else "pyrometer"
            basis = courses[whose] if kind == "walk" and last != "gas" else None
            name = SINGLE_NAMES[kind].format(name=one.name)
            singles.append(Structure(f"one_{one.id}", name, one.columns, True, basis))
    for place, one in spectral:
        if one.id != "pattern":
            lines = _shapes(model, place)
            singles.append(Structure(f"line_{one.id}", f"one line: {one.name}", one.columns, True, lines))
    for place, one in spectral:
        if one.id == "pattern":
            name, fringes = "fringes over wavelength, always", _fringes(model, place)
            singles.append(Structure("fringe_pattern", name, one.columns, True, fringes))
    return singles


SINGLE_NAMES = {
    "walk": "one step, moment or slow change: {name}",
    "wave": "{name}",
    "heat": "{name}",
    "signal": "{name} that changes along the signal",
    "pattern": "one channel: {name}",
    "gas": "one channel: {name}",
    "released": "one channel: {name}",
}
MAP_PLACES = (0.01, 1 / 30, 1 / 12, 0.2, 0.5, 299 / 300, 305 / 300, 1.1)  # shares of the exposure
GROWN = 1 / 15  # of the exposure: how fast the light of the surface comes up
PHASES = np.arange(3) * np.pi / 3
SLOW = (0.05, 0.1, 0.2)  # of the exposure: how long a slow change lasts,
SETTLED = (0.1, 0.3, 1.0)  # and time constants with which one settles
HEAT = (1.0, 2.0, 4.0, 8.0)  # powers of the temperature, and of the wavelength over the pivot,
TILTS, PIVOT = (-2.0, 0.0, 2.0), 0.95e-6  # [m]
CODES = np.arange(1.5, 16.1, 0.5)  # periods along the whole signal: below, a bend is a non-linearity
WAVING = ("pyrometer", "ratio")


def _late(model, solution, place, value, before):
    """Changes (k, n, C) of values (n, C) by clocks that are off by some times where the plasma ends, which no
    slope of a signal says, and their columns (k, n, before + k)."""
    state, time = solution.state, model.instruments[place].time
    shares = np.zeros((len(MOVED), time.size, before + len(MOVED)))
    shares[np.arange(len(MOVED)), :, before + np.arange(len(MOVED))] = np.abs(time - model.off) < NEAR_END
    changes = [
        model.evaluate(
            place,
            state.knots,
            state.values,
            (*solution.settings, Setting(clocks_apart, late, {})),
            gas_error=state.error_of_gas(place),
        )
        * (1 + state.pattern[place])
        + state.dark[place]
        - value
        for late in MOVED
    ]
    return changes, shares


def _places(time, off, steps):
    """Bins (m,) with which so many steps of a walk begin, and those with which a surface comes into view and
    a plasma ends."""
    places = np.linspace(1, time.size - 1, min(steps, time.size - 1)).astype(int)
    ends = np.searchsorted(time, [0.0, off])
    return np.unique(np.concatenate([places, ends[(ends > 0) & (ends < time.size)]]))


def _spans(time, places):
    """Shares (m,) of the record from each step to the next."""
    span = np.diff(np.append(time[places], time[-1] + 1.0))
    return span / span.sum()


def _walk(time, off, steps):
    """Steps (n, m) of a random walk of unit variance over the whole record, about so many."""
    places = _places(time, off, steps)
    return (np.arange(time.size)[:, None] >= places) * np.sqrt(_spans(time, places))


def _courses(time, off, steps):
    """Combinations (m, b) of the steps of a walk: each of them, moments, and what changes slowly once, for
    good or as long as the plasma burns."""
    places = _places(time, off, steps)
    edges, mean = time[places], np.add.reduceat(time, places) / np.diff(np.append(places, time.size))
    middle = np.append(time[: places[0]].mean(), mean)[:, None]  # of what lies between two steps
    burning = middle < off
    moments = (middle > edges) & (middle < np.append(edges[1:], np.inf))
    begun = edges[(edges >= 0) & (edges < off)]
    slow = [np.clip((middle - begun) / (share * off), 0.0, 1.0) for share in SLOW]
    once = [(middle > begun).astype(float), *slow]
    settling = [_settling(middle[:, 0], start, off) for start in (0.0, time[0])]
    shapes = np.hstack([moments, *slow, *(one * burning for one in once), *settling])
    return np.hstack([np.eye(places.size), np.diff(shapes, axis=0) / np.sqrt(_spans(time, places))[:, None]])


def _settling(time, start, off):
    """What settles from a time [s] on (n, s), with the time constants `SETTLED`."""
    return -np.expm1(-np.maximum(time - start, 0.0)[:, None] / (np.array(SETTLED) * off))


def _heat(model, solution, time):
    """Powers (n, h) of the temperature of the surface over its highest: of what warms in its light."""
    temperature = np.maximum(model.history.basis(time) @ solution.state.knots, 0.0)
    return (temperature / temperature.max())[:, None] ** HEAT


def _waves(time, off):
    """Oscillations (n, m) with periods from `SHORTEST_PERIOD` to the length of the test, at three phases."""
    span = max(min(off, time[-1]), 4 * SHORTEST_PERIOD)
    periods = span / np.arange(1.0, span / SHORTEST_PERIOD + 0.01, 0.5)
    angle = 2 * np.pi * time[:, None, None] / periods[:, None] + PHASES
    return np.sin(angle).reshape(time.size, -1)


def _codes(signal):
    """Gains (n, m) that come and go along a signal (n,), as those of a converter with unequal steps do."""
    angle = 2 * np.pi * (signal / signal.max())[:, None, None] * CODES[:, None] + PHASES
    return np.sin(angle).reshape(signal.size, -1)


def _ranges(signal):
    """Gains (n, m) that are another one above a level of the signal (n,): at most `WALK_STEPS` levels by how
    often it has them, and as many at equal distances, for a steady state takes most of the first."""
    order = np.sort(signal)
    places = np.linspace(0, order.size - 2, min(WALK_STEPS, order.size - 1)).astype(int)
    even = np.searchsorted(order, np.linspace(order[0], order[-1], WALK_STEPS + 2)[1:-1]) - 1
    places = np.unique([*places, *np.clip(even, 0, order.size - 2)])
    return (signal[:, None] > (order[places] + order[places + 1]) / 2).astype(float)


def _fringes(model, place):
    r"""Fringes (C, b) :math:`\sin(2\pi n x + \varphi)` over the wavenumber x, 0 to 1 over the spectrum.

    From 4 fringes (slower ones are no fringes but a slope) to what the median channel can follow.
    """
    wavenumber = 1 / model.instruments[place].wavelength
    x = (wavenumber - wavenumber.min()) / np.ptp(wavenumber)
    fastest = 0.5 / np.median(np.abs(np.diff(x)))
    count = np.arange(4.0, max(fastest, 4.5), 0.5)
    angle = 2 * np.pi * x[:, None, None] * count[:, None] + PHASES
    return np.sin(angle).reshape(x.size, -1)


def _shapes(model, place):
    return line_shapes(model.instruments[place].wavelength, model.library.slit_fwhm)[0]


def _common_walk(instruments, off):
    """Steps (n, m) per instrument of a random walk of the brightness of the gas that all see."""
    ends = np.linspace(0.0, off, WALK_STEPS + 1)[:-1]
    return [(instrument.time[:, None] >= ends) / np.sqrt(WALK_STEPS) for instrument in instruments]


def _spectral_patterns(model, solution, time, value, gas):
    """Rows (n, C) of the classes of patterns over wavelength."""
    temperature = np.maximum(model.history.basis(time) @ solution.state.knots, 250.0)
    burning = time < model.off
    level = np.median(gas[burning], axis=0).mean()
    grown = -np.expm1(-np.maximum(time, 0) / (GROWN * model.off))
    released = np.exp(np.clip(GROWTH * (1 - 1600.0 / temperature), -60, 2)) * ((time > 0) & burning)
    one = np.ones(value.shape[1])
    yield "pattern", "fixed pattern over wavelength", value
    yield (
        "surface_pattern",
        "pattern in the light of the surface",
        np.maximum(value - gas, 0.0) * grown[:, None],
    )
    yield "gas_pattern", "unknown light over wavelength, with the plasma", gas.mean(axis=1)[:, None] * one
    yield (
        "released_pattern",
        "unknown light over wavelength, with a hot surface",
        released[:, None] * level * one,
    )


def _smooth(model, one):
    """Waves (w, C) over the channels and, for each, hats in time as shares (n, m): a smooth map."""
    time = one.time
    x = np.clip((one.wavelength - one.wavelength[0]) / (one.wavelength[-1] - one.wavelength[0]), 0, 1)
    waves = np.cos(np.pi * np.arange(1, MAP_WAVES + 1)[:, None] * x)
    before = 0.5 * min(time[0], -GROWN * model.off)
    places = np.array([before, *during(MAP_PLACES, model.off)])
    hats = np.stack([np.interp(time, places, row) for row in np.eye(places.size)], axis=1)
    return waves, [np.kron(own, hats) for own in np.eye(MAP_WAVES)]
