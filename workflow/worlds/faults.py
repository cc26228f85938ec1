"""What may be hidden: the effects of the catalogue by own formulas, and faults of real tunnels that no
catalogue holds.

An effect is a function of a `Scene`, an amplitude, further parameters and a `Context`; it returns a changed
scene. The table `effects` holds ranges of amplitudes and parameters; of a fault also which instruments are
wrong ('p', 's', 'ps'), along which axis (time, wavelength, temperature, signal), and why tunnels have it.
"""

from dataclasses import dataclass

import numpy as np

from worlds.engine import CENTRES
from worlds.gas import table
from worlds.laboratory import SMOOTH, planck

MICRON = SMOOTH * 1e6
EFFECTS = {}


@dataclass(frozen=True)
class Effect:
    """Entry of the table of effects."""

    apply: object
    unit: float  # amplitude to begin with
    low: float
    high: float
    shape: dict  # name: (low, high), drawn uniformly
    truth: tuple  # of a fault: (instruments, axis)
    gas: bool  # acts on the light of the gas alone


@dataclass
class Context:
    """What effects need besides the scene."""

    lab: object
    total: np.ndarray  # light of the gas (bins,)
    continuum: np.ndarray
    variant: object  # (kind, amplitude) -> light of the gas (bins,)
    signals: np.ndarray  # of the gas after injection (2,) [A]
    rate: np.ndarray  # of the gas after injection (W,)
    highest: tuple  # largest signals (2,) and rate of the base
    seed: int


def effect(name):
    """Register a function of (scene, amplitude, shape, context) with its row of the table."""
    row = next(row for row in table("effects") if row["effect"] == name)
    words = [part.split() for part in row["shape"].split(";") if part]
    shape = {key: (float(low), float(high)) for key, low, high in words}
    truth = (row["instruments"], row["axis"]) if row["axis"] else ()

    def register(function):
        EFFECTS[name] = Effect(
            function, row["unit"], row["low"], row["high"], shape, truth, row["gas"] == "yes"
        )
        return function

    return register


def formulas(**functions):
    """Register effects of one line each."""
    for name, function in functions.items():
        effect(name)(function)


def _scaled(scene, factor, instruments="ps", where="surface"):
    """A copy with surface or path of some instruments times a factor that broadcasts to (t, SMOOTH)."""
    changed = scene.copy()
    part = getattr(changed, where)
    for one in instruments:
        part[one] = part[one] * factor
    return changed


def _added(scene, light, instruments="ps"):
    changed = scene.copy()
    for one in instruments:
        changed.surface[one] = changed.surface[one] + light
    return changed


def _glow(scene, spectrum, amplitude, instruments="ps"):
    return scene.copy(gas=[*scene.gas, (instruments, amplitude, spectrum)])


def _regas(scene, spectrum):
    (whom, amplitude, _), *others = scene.gas
    return scene.copy(gas=[(whom, amplitude, spectrum), *others])


def _reading(scene, function):
    return scene.copy(readings=[*scene.readings, function])


def _rate(scene, function):
    return scene.copy(rates=[*scene.rates, function])


def _since(scene):
    """Share of 300 s for which plasma has shone on the sample (t,)."""
    return np.clip(scene.time, 0, scene.off) / 300.0


def _column(values):
    return np.asarray(values)[:, None]


def peaks(wavelengths, strengths, width=0.05e-9):
    """Lines of unit sum of strengths over the bins."""
    weights = np.array(strengths) / np.sum(strengths)
    light = sum(
        w * np.exp(-0.5 * ((CENTRES - at * 1e-9) / width) ** 2)
        for at, w in zip(wavelengths, weights, strict=True)
    )
    return light / (width * np.sqrt(2 * np.pi))


# ---- light of the gas
for _name in ("P_eff", "T_exc", "T_vib", "ripple", "selfabs"):
    effect(_name)(lambda s, a, p, c, kind=_name: _regas(s, c.variant(kind, a)))


effect("contin")(lambda s, a, p, c: _regas(s, s.gas[0][2] + a * c.continuum))


@effect("bl")
def _bl(s, a, p, c):
    more = c.variant("bl", 1.0) - c.total
    return _glow(s, more, a * np.clip((s.kelvin - 350) / 1250, 0, None) * s.plasma * s.seen)


def _brighter(s, factor):
    return s.copy(gas=[(whom, amplitude * factor, light) for whom, amplitude, light in s.gas])


effect("gas_drift")(lambda s, a, p, c: _brighter(s, 1 + a * np.clip(s.time, 0, None) / 300))


@effect("refl")
def _refl(s, a, p, c):
    scattered = p["diffuse"] * 3 * c.variant("P_eff", 0.28)  # the core of the torch seen by a matt surface
    light = (1 - s.emittance) * a * ((1 - p["diffuse"]) * c.total + scattered)
    return _glow(s, light, s.plasma * s.seen)


@effect("second")
def _second(s, a, p, c):
    # N2+ first negative 0-2, 1-3, 2-4 and N I 491.5, 493.5 nm at twice their wavelengths
    images = peaks([941.8, 930.5, 919.9, 983.3, 987.2], [1, 0.8, 0.5, 0.2, 0.3], 1.5e-9)
    return _glow(s, c.total.mean() * images / images.max(), a * s.gas[0][1], "s")


# ---- lines of other atoms (NIST ASD; air wavelengths + 0.22 nm), in units of a fiftieth of the light of
# the gas
SPECIES = {
    "NaK": ([818.55, 819.70, 766.70, 770.11], [0.5, 1, 1, 0.5], True),
    "CaII": ([850.04, 854.44, 866.45], [0.13, 1, 0.55], True),
    "CN": (
        [head + nm for head in (787.5, 806.9, 914.4, 938.5, 1093.3) for nm in range(12)],
        [12 - nm for _ in range(5) for nm in range(12)],
        True,
    ),
    "Cu": ([793.53, 809.48], [0.6, 1], False),
    "Ar": ([763.72, 811.75, 842.70, 912.55], [1, 1, 0.6, 0.8], False),
}


def _metal(name):
    lines, strengths, hot = SPECIES[name]

    def apply(s, a, p, c):
        light = peaks(lines, strengths) * 0.02 * c.total.sum() * (CENTRES[1] - CENTRES[0])
        history = s.plasma * (np.exp(-12000 * (1 / s.kelvin - 1 / 1600)) * s.seen if hot else 1.0)
        return _glow(s, light, a * history)

    return apply


for _name in SPECIES:
    effect(_name)(_metal(_name))


# ---- surface
formulas(
    eps_slope=lambda s, a, p, c: _scaled(s, 1 + a * (MICRON - 0.95)),
    eps_T=lambda s, a, p, c: _scaled(s, 1 + a * (_column(s.kelvin) - 350) / 1250),
    eps_ox=lambda s, a, p, c: _scaled(s, 1 + a * _column(1 - np.exp(-np.clip(s.time, 0, None) / p["tau_s"]))),
)


@effect("grad")
def _grad(s, a, p, c):
    """Patches: all temperatures between two have equal areas, of the same mean in both spots."""
    points, weights = np.polynomial.legendre.leggauss(7)
    kelvin = _column(s.kelvin)
    seen = s.emittance * _column(s.seen)  # not what grains add
    for who, sigma in (("p", a), ("s", a * np.sqrt(p["share"]))):
        apart = np.sqrt(3) * sigma
        bodies = [planck(SMOOTH, np.maximum(kelvin + apart * point, 200.0)) for point in points]
        s = _added(s, seen * (np.tensordot(weights / 2, bodies, 1) - planck(SMOOTH, kelvin)), who)
    return s


def _edge(instrument):
    def apply(s, a, p, c):
        cover = np.interp(s.time - p["lag_s"], s.time, s.kelvin) * p["cooler"]
        light = 0.8 * planck(SMOOTH, _column(np.maximum(cover, 300))) * _column(s.seen)
        return _added(_scaled(s, 1 - a, instrument), a * light, instrument)

    return apply


for _name, _who in (("edge_p", "p"), ("edge_s", "s")):
    effect(_name)(_edge(_who))


@effect("torchglow")
def _torchglow(s, a, p, c):
    decay = np.where(s.time < s.off, 1.0, np.exp(-(s.time - s.off) / p["tau_s"]))
    return _added(s, a * (1 - s.emittance) * planck(SMOOTH, p["quartz_k"]) * _column(decay * s.seen))


effect("particles")(lambda s, a, p, c: _added(s, a * planck(SMOOTH, 2300.0) * _column(s.plasma * s.seen)))


@effect("scat")
def _scat(s, a, p, c):
    loss = a / (MICRON / 0.95) * _column(s.plasma * s.seen)
    return _glow(_scaled(s, 1 - loss), 0.5 * c.total * 0.95e-6 / CENTRES, a * s.plasma * s.seen)


# ---- path
def _window(who, slope):
    def apply(s, a, p, c):
        blue = (MICRON / 0.95) ** -p["n"] if slope else 1.0
        return _scaled(s, 1 - a * blue * _column(_since(s)), who, "path")

    return apply


for _who, _name in (("p", "winD"), ("s", "winE")):
    effect(_name)(_window(_who, False))
    effect(f"{_name}_sl")(_window(_who, True))


def _absorption(heads):
    depth = sum(
        h * np.exp(-np.abs(CENTRES * 1e9 - at) / w) * (1 + 0.5 * np.cos((CENTRES * 1e9 - at) * 3))
        for at, w, h in heads
    )
    depth /= depth.max()
    return lambda s, a, p, c: s.copy(fine=s.fine * np.exp(-a * depth))


for _name, _heads in (
    ("h2o", [(935, 8, 1), (950, 9, 0.6), (820, 5, 0.1), (1125, 14, 1.2)]),
    ("o2a", [(760.8, 0.7, 1), (764.2, 1.6, 0.6)]),
):
    effect(_name)(_absorption(_heads))


# ---- instruments
formulas(
    off1=lambda s, a, p, c: _reading(s, lambda t, x: x + a * c.signals[0] * np.array([[1.0], [0.0]])),
    off2=lambda s, a, p, c: _reading(s, lambda t, x: x + a * c.signals[1] * np.array([[0.0], [1.0]])),
    off_s=lambda s, a, p, c: _rate(s, lambda t, r: r + a * c.rate.mean()),
    nonlin_p=lambda s, a, p, c: _reading(s, lambda t, x: x * (1 - a * x / c.highest[0][:, None])),
    nonlin_s=lambda s, a, p, c: _rate(s, lambda t, r: r * (1 - a * r / c.highest[1])),
    phi=lambda s, a, p, c: _reading(s, lambda t, x: x * np.array([[1 + a], [1.0]])),
)


def _shifted(row, nanometres):
    """A response with its short-wavelength flank moved, up to 1020 nm."""
    flank = np.interp(SMOOTH - nanometres * 1e-9, SMOOTH, row)
    return np.where((SMOOTH > 650e-9) & (SMOOTH < 1.02e-6), flank, row)


for _band, _name in enumerate(("edge1", "edge2")):

    @effect(_name)
    def _edges(s, a, p, c, band=_band):
        bands = s.bands.copy()
        bands[band] = _shifted(bands[band], a)
        return s.copy(bands=bands)


formulas(
    resp_long=lambda s, a, p, c: s.copy(bands=s.bands * (1 + a * np.clip((MICRON - 1.0) / 0.1, 0, 1))),
    wshift=lambda s, a, p, c: s.copy(shift=s.shift + a * 1e-9),
    lsf=lambda s, a, p, c: s.copy(blur=a * 1e-9),
    stray=lambda s, a, p, c: _rate(s, lambda t, r: (1 - a) * r + a * r.mean(axis=1, keepdims=True)),
    clock=lambda s, a, p, c: s.copy(clock=lambda t: t + a),
)


CATALOGUE = tuple(EFFECTS)


# ---- faults that no catalogue holds
effect("range_change")(
    lambda s, a, p, c: _reading(
        s, lambda t, x: x * np.where(x[:1] > p["level"] * c.highest[0][0], 1 + a, 1.0)
    )
)


@effect("window_etalon")
def _window_etalon(s, a, p, c):
    pixels = c.lab.wavelength * 1e9
    fringe = np.cos(2 * np.pi * 850**2 / p["period_nm"] / pixels + p["phase"])
    return _rate(s, lambda t, r: r * (1 + a * fringe))


@effect("fibre_bend")
def _fibre_bend(s, a, p, c):
    loss = np.exp((c.lab.wavelength - 950e-9) / 120e-9)
    return _rate(s, lambda t, r: r * (1 - a * loss * (t > p["at"] * s.off)[:, None]))


effect("hum")(
    lambda s, a, p, c: _reading(
        s, lambda t, x: x + a * c.signals[:, None] * np.sin(2 * np.pi * p["beat_hz"] * t)
    )
)


@effect("double_frames")
def _double_frames(s, a, p, c):
    def apply(t, r):
        hit = np.random.default_rng(c.seed).random(t.size) < p["share"]
        return r * (1 + a * hit[:, None])

    return _rate(s, apply)


formulas(
    image_lag=lambda s, a, p, c: _rate(s, lambda t, r: (1 - a) * r + a * np.concatenate([r[:1], r[:-1]])),
    ghost=lambda s, a, p, c: _rate(s, lambda t, r: r + a * r[:, ::-1]),
    preamp_drift=lambda s, a, p, c: _reading(
        s,
        lambda t, x: (
            x + a * c.signals[:, None] * [[0.0], [1.0]] * (1 - np.exp(-np.clip(t + 20, 0, None) / p["tau_s"]))
        ),
    ),
)


@effect("warm_dark")
def _warm_dark(s, a, p, c):
    pattern = np.random.default_rng(c.lab.seed).gamma(4, 0.25, c.lab.pixels)
    return _rate(
        s,
        lambda t, r: (
            r
            + a * c.rate.mean() * (2 ** (p["kelvin"] / 7 * np.clip(t / s.off, 0, 1.2)) - 1)[:, None] * pattern
        ),
    )


effect("wavelength_drift")(
    lambda s, a, p, c: s.copy(shift=s.shift + a * 1e-9 * (1 - np.exp(-np.clip(s.time, 0, None) / p["tau_s"])))
)


@effect("flake")
def _flake(s, a, p, c):
    seen = np.exp(-0.5 * ((s.time - p["at"] * s.off) / p["lasts_s"]) ** 2)
    return _added(s, a * planck(SMOOTH, 1.12 * _column(s.kelvin)) * _column(seen * s.plasma))


@effect("blister")
def _blister(s, a, p, c):
    grown = a * np.clip((s.time - p["at"] * s.off) / 20, 0, 1) * s.plasma
    ratio = planck(SMOOTH, _column(s.kelvin) + p["hotter_k"]) / planck(SMOOTH, _column(s.kelvin))
    return _scaled(s, 1 + _column(grown) * (ratio - 1))


effect("sting_vibration")(
    lambda s, a, p, c: _scaled(s, 1 + a * _column(np.sin(2 * np.pi * p["beat_hz"] * s.time) * s.seen))
)


@effect("arc_restart")
def _arc_restart(s, a, p, c):
    level = np.where(s.time < p["at"] * s.off, 1.0, 1 + a) * np.where(
        np.abs(s.time - p["at"] * s.off) < 1.0, 0.0, 1.0
    )
    return s.copy(
        gas=[(w, amplitude * np.where(s.time > 0, level, 1.0), light) for w, amplitude, light in s.gas]
    )


@effect("purge_leak")
def _purge_leak(s, a, p, c):
    light = peaks([760.36, 785.70, 811.51, 830.04, 877.92, 893.11], [1, 0.5, 1, 0.6, 0.7, 0.6])
    return _glow(s, light * 0.02 * c.total.sum() * 2e-11, a * s.gas[0][1])


@effect("copper_burst")
def _copper_burst(s, a, p, c):
    light = peaks(*SPECIES["Cu"][:2]) * 0.02 * c.total.sum() * 2e-11
    return _glow(
        s,
        light,
        a
        * s.plasma
        * np.exp(-np.clip(s.time - p["at"] * s.off, 0, None) / p["lasts_s"])
        * (s.time > p["at"] * s.off),
    )


@effect("seeded_water")
def _seeded_water(s, a, p, c):
    light = peaks([886.53, 901.74, 923.15, 954.86, 1005.22, 1094.11], [0.2, 0.3, 0.4, 0.5, 0.7, 1], 0.3e-9)
    return _glow(s, light * 0.02 * c.total.sum() * 2e-11, a * s.gas[0][1])


formulas(
    cover_shadow=lambda s, a, p, c: _scaled(
        s, 1 - a * _column(np.clip((s.time - p["at"] * s.off) / p["over_s"], 0, 1)), "ps", "path"
    ),
    clock_ppm=lambda s, a, p, c: s.copy(clock=lambda t: t * (1 - a)),
    dropped_samples=lambda s, a, p, c: s.copy(clock=lambda t: t + a * (t > p["at"] * s.off)),
)


@effect("warm_filter")
def _warm_filter(s, a, p, c):
    bands = s.bands.copy()
    bands[1] = _shifted(bands[1], a)
    moved = s.copy(bands=bands)
    share = _column(1 - np.exp(-np.clip(s.time, 0, None) / p["tau_s"]))
    ratio = (planck(SMOOTH, _column(s.kelvin)) @ moved.bands[1]) / (
        planck(SMOOTH, _column(s.kelvin)) @ s.bands[1]
    )
    history = 1 + share[:, 0] * (ratio - 1)
    return _reading(s, lambda t, x: x * np.array([np.ones(t.size), np.interp(t, s.time, history)]))


effect("missing_codes")(
    lambda s, a, p, c: _reading(
        s, lambda t, x: x * (1 + a * np.sin(2 * np.pi * p["steps"] * x / c.highest[0][:, None]))
    )
)


@effect("fatigue")
def _fatigue(s, a, p, c):
    def apply(t, r):
        dose = np.cumsum(r.mean(axis=1))
        return r * (1 - a * dose / dose[-1])[:, None]

    return _rate(s, apply)


formulas(
    odd_even=lambda s, a, p, c: _rate(
        s, lambda t, r: r * (1 + a * (-1.0) ** (np.arange(r.shape[1]) // max(1, r.shape[1] // 400)))
    ),
    stitch=lambda s, a, p, c: _rate(
        s, lambda t, r: r * (1 + a * (np.arange(r.shape[1]) > p["at"] * r.shape[1]))
    ),
)


@effect("room_light")
def _room_light(s, a, p, c):
    lamp = planck(SMOOTH, 2900.0) / planck(SMOOTH, 2900.0).mean() * c.total.mean()
    return _added(s, a * lamp * _column(s.time > p["at"] * s.off))


@effect("coating_darkens")
def _coating_darkens(s, a, p, c):
    load = (s.kelvin / s.kelvin.max()) ** 4
    return _scaled(s, 1 - a * _column(load) * (MICRON / 0.95) ** -2, "s", "path")


OUTSIDE = tuple(name for name, entry in EFFECTS.items() if entry.truth)
