"""Effects that can be hidden in a synthetic test, each a change of the `Scene` with its own formula.

`CATALOGUE` holds effects that a diagnosis may know by name; `OUTSIDE` those that it must not: they are
kept here only. Amplitude 0 changes nothing. `hide` composes any number of them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import partial
from typing import NamedTuple

import numpy as np

from twin import lines
from twin.campaign import Plume, Scene
from twin.gas import Gas, heads, narrow, oxygen_band
from twin.light import planck
from twin.sample import history

MICROMETRE, NANOMETRE = 1e-6, 1e-9
CENTRE = 0.95 * MICROMETRE  # where spectral slopes turn
HOT = 1600.0  # [K] surface temperature at which growing effects reach their amplitude


@dataclass(frozen=True)
class Hidden:
    """One effect: `apply(scene, amplitude, shape, gas)` returns the changed scene."""

    apply: Callable
    unit: float  # amplitude of a plain case
    low: float  # least and greatest amplitude that is physically sensible
    high: float
    shape: dict = field(default_factory=dict)  # name: (least, greatest) of its other parameters

    def middle(self):
        """The shape in the middle of its range."""
        return {name: (low + high) / 2 for name, (low, high) in self.shape.items()}


# ---- composing hooks -------------------------------------------------------------------------------------


def _emittance(scene, factor):
    """Multiply the emittance by factor(wavelength, temperature, time)."""
    before = scene.surface_emittance
    return replace(
        scene, emittance=lambda wl, kelvin, time: before(wl, kelvin, time) * factor(wl, kelvin, time)
    )


def _window(scene, only, factor):
    """Multiply what an instrument (or both: None) sees by factor(wavelength, time)."""
    before = scene.transmittance

    def transmittance(instrument, wavelength, time):
        base = before(instrument, wavelength, time)
        return base * factor(wavelength, time) if only in (None, instrument) else base

    return replace(scene, transmittance=transmittance)


def _add_light(scene, radiance):
    """Add radiance(instrument, wavelength, time, temperature)."""
    before = scene.extra_radiance
    return replace(scene, extra_radiance=lambda *state: before(*state) + radiance(*state))


class State(NamedTuple):
    """What the share of a `Plume` gets."""

    instrument: str
    wavelength: np.ndarray
    time: np.ndarray
    kelvin: np.ndarray
    scale: np.ndarray
    emittance: np.ndarray


def _add_plume(scene, gas, spectrum, share):
    """Add light of a spectrum times share(state)."""
    plume = Plume(gas.centres, spectrum, lambda *state: share(State(*state)))
    return replace(scene, plumes=(*scene.plumes, plume))


def _glow(scene, only, change):
    """Let change(instrument, wavelength, temperature, time, radiance so far) replace the surface's glow."""
    before = scene.glow

    def glow(instrument, wavelength, temperature, time):
        seen = before(instrument, wavelength, temperature, time)
        return change(instrument, wavelength, temperature, time, seen) if only in (None, instrument) else seen

    return replace(scene, glow=glow)


def _pyrometer(scene, change):
    before = scene.pyrometer_output
    return replace(scene, pyrometer_output=lambda clean, time: change(before(clean, time), time))


def _spectrometer(scene, change):
    before = scene.spectrometer_output
    return replace(scene, spectrometer_output=lambda rate, time: change(before(rate, time), time))


def _response(scene, change):
    """Let change(band, wavelength, responsivity) replace the responsivity."""
    before = scene.response
    return replace(
        scene, response=lambda band, wl, curve: change(band, wl, np.asarray(before(band, wl, curve)))
    )


def _burning(scene, time):
    return time <= scene.plasma_off_time


def _exposed(scene, time):
    """Share of the exposure that has passed, 0 before and 1 after it."""
    return np.clip(time / scene.plasma_off_time, 0.0, 1.0)


def _growth(temperature, steepness=12.0):
    """Release of matter by the surface, 1 at 1600 K."""
    return np.exp(np.clip(steepness * (1 - HOT / temperature), -60, 3))


def _in_window(scene, signals, time):
    """Mean (2, 1) of signals in the reference window, its first two seconds after the swing left out."""
    first, last = scene.reference_window
    return signals[:, (time >= first) & (time <= last)].mean(axis=1, keepdims=True)


# ---- the surface -----------------------------------------------------------------------------------------


def _slope(scene, a, shape, gas):
    return _emittance(scene, lambda wl, kelvin, time: 1 + a * (wl - CENTRE) / MICROMETRE)


def _with_temperature(scene, a, shape, gas):
    return _emittance(scene, lambda wl, kelvin, time: 1 + a * (kelvin - 350.0) / 1250.0)


def _oxidation(scene, a, shape, gas):
    tau = shape["tau_s"]
    return _emittance(scene, lambda wl, kelvin, time: 1 - a * np.expm1(-np.maximum(time, 0) / tau))


def _reflection(scene, a, shape, gas):
    spectrum = gas.reflected(shape["diffuse"])
    return _add_plume(
        scene, gas, spectrum, lambda s: np.where(s.time >= 0, a * (1 - s.emittance) * s.scale, 0.0)
    )


def _torch_glow(scene, a, shape, gas):
    colour, decay = shape["glow_k"], shape["decay_s"]

    def radiance(instrument, wl, time, kelvin):
        off = np.exp(-np.maximum(time - scene.plasma_off_time, 0) / decay)
        mirror = 1 - scene.surface_emittance(wl, kelvin, time)
        return np.where(time >= 0, a * mirror * off * planck(wl, colour), 0.0)

    return _add_light(scene, radiance)


def _spread(scene, a, shape, gas):
    """Root mean square spread `a` [K] of temperature in the pyrometer's spot; the smaller spot sees less."""

    def change(instrument, wl, kelvin, time, seen):
        sigma = a * (1.0 if instrument == "pyrometer" else shape["spot_ratio"])
        return (planck(wl, kelvin + sigma) + planck(wl, kelvin - sigma)) / 2 - planck(wl, kelvin) + seen

    return _glow(scene, None, change)


def _cover(only, scene, a, shape, gas):
    """A share of the spot falls on the cover, cooler and late."""
    tick = np.arange(scene.start, scene.end + 5.0, 0.1)
    surface = history(scene.sample, tick, scene.plasma_off_time)
    lagging, keep = np.empty_like(surface), np.exp(-0.1 / shape["lag_s"])
    lagging[0] = surface[0]
    for index in range(1, tick.size):
        lagging[index] = keep * lagging[index - 1] + (1 - keep) * surface[index]
    cover = 350.0 + shape["ratio"] * (lagging - 350.0)

    def change(instrument, wl, kelvin, time, seen):
        return (1 - a) * seen + a * planck(wl, np.interp(time, tick, cover))

    return _glow(scene, only, change)


# ---- windows and path ------------------------------------------------------------------------------------


def _deposit(only, scene, a, shape, gas):
    return _window(scene, only, lambda wl, time: 1 - a * _exposed(scene, time))


def _blue_deposit(only, scene, a, shape, gas):
    power = shape["power"]
    return _window(scene, only, lambda wl, time: 1 - a * (wl / CENTRE) ** -power * _exposed(scene, time))


def _water(scene, a, shape, gas):
    place, depth = np.array(lines.WATER).T
    return _window(scene, None, lambda wl, time: np.exp(-a * np.interp(wl / NANOMETRE, place, depth)))


def _oxygen(scene, a, shape, gas):
    return _window(scene, None, lambda wl, time: np.exp(-a * oxygen_band(wl)))


def _scattering(scene, a, shape, gas):
    return _window(
        scene,
        None,
        lambda wl, time: 1 - np.where((time >= 0) & _burning(scene, time), a, 0.0) * (CENTRE / wl) ** 2,
    )


# ---- the gas ---------------------------------------------------------------------------------------------


def _as_gas(s):
    return s.scale


def _other_spectrum(spectrum, scene, a, shape, gas):
    """Replace the spectrum of the gas by spectrum(gas, amplitude)."""
    return _add_plume(scene, gas, spectrum(gas, a) - gas.total, _as_gas)


def _drift(scene, a, shape, gas):
    return _add_plume(scene, gas, gas.total, lambda s: a * s.scale * _exposed(scene, s.time))


def _warm_layer(scene, a, shape, gas):
    """The layer before a hot wall is warmer: its share of the molecular light grows with the wall's."""
    molecules = gas.radiance[gas.systems.index("N2 1P")] + gas.radiance[gas.systems.index("N2+ Meinel")]

    def share(s):
        return np.where(s.time >= 0, 0.004 * a * s.scale * (s.kelvin - 350.0) / 1250.0, 0.0)

    return _add_plume(scene, gas, molecules, share)


def _afterglow(scene, a, shape, gas):
    weak = gas.total if gas.weakest is None else gas.weakest

    def share(s):
        after = s.time - scene.plasma_off_time
        return np.where(after > 0, a * np.exp(-np.maximum(after, 0) / shape["decay_s"]), 0.0)

    return _add_plume(scene, gas, weak, share)


def _continuum(scene, a, shape, gas):
    """More light of free electrons: flat emission coefficient per frequency at 6000 K."""
    mean = 6000.0
    free = np.exp(-1.438776877e-2 / (gas.centres * mean)) / gas.centres**2
    faint = gas.radiance[[name.startswith(("e-", "O- ", "free")) for name in gas.systems]].sum(axis=0)
    return _add_plume(scene, gas, a * free * faint.mean() / free.mean(), _as_gas)


def _particles(scene, a, shape, gas):
    """Hot grains fly through: a gamma-distributed crowd, seen by both instruments at once."""
    random = np.random.default_rng(int(shape["pattern"]))
    tick = np.arange(scene.start, scene.end + 5.0, 0.05)
    crowd = random.gamma(4.0, 0.25, tick.size)

    def radiance(instrument, wl, time, kelvin):
        present = (time > 0) & _burning(scene, time)
        number = np.where(present, np.interp(time, tick, crowd), 0.0)
        return a * number * planck(wl, shape["grain_k"])

    return _add_light(scene, radiance)


def _line_light(listed, power, released, scene, a, shape, gas):
    """Lines (place, strength); released by the surface, or there whenever the plasma is."""
    place, strength = np.array([row[:2] for row in listed]).T
    spectrum = narrow(gas.centres, place, a * power * strength / strength.sum())

    def share(s):
        return np.where((s.time >= 0) & _burning(scene, s.time), s.scale * _growth(s.kelvin), 0.0)

    return _add_plume(scene, gas, spectrum, share if released else _as_gas)


def _argon(scene, a, shape, gas):
    place, strength, level = np.array(lines.ARGON).T
    excited = strength * np.exp(-1.438776877 * (level - level.min()) / 6000.0)
    return _line_light(tuple(zip(place, excited, strict=True)), 0.02, False, scene, a, shape, gas)


def _cyanogen(scene, a, shape, gas):
    upper, place, strength = np.array(lines.CYANOGEN).T
    excited = strength * np.exp(-1.438776877 * lines.CYANOGEN_QUANTUM * upper / 5000.0)
    spectrum = heads(gas.centres, place, a * 0.02 * excited, 9.0, red=True)

    def share(s):
        present = (s.time >= 0) & _burning(scene, s.time)
        fading = np.exp(-np.maximum(s.time, 0) / 200.0)
        return np.where(present, s.scale * _growth(s.kelvin, 6.0) * fading, 0.0)

    return _add_plume(scene, gas, spectrum, share)


# ---- the pyrometer ---------------------------------------------------------------------------------------


def _offset(band, scene, a, shape, gas):
    def change(clean, time):
        extra = np.zeros_like(clean)
        extra[band] = a * _in_window(scene, clean, time)[band]
        return clean + extra

    return _pyrometer(scene, change)


def _compressed_signal(scene, a, shape, gas):
    return _pyrometer(scene, lambda clean, time: clean * (1 - a * clean / clean.max(axis=1, keepdims=True)))


def _ratio(scene, a, shape, gas):
    return _pyrometer(scene, lambda clean, time: clean * np.exp(a * np.array([[1.0], [0.0]])))


def _edge(which, scene, a, shape, gas):
    def change(band, wl, curve):
        return np.interp(wl - a * NANOMETRE, wl, curve) if band == which else curve

    return _response(scene, change)


def _tail(scene, a, shape, gas):
    def change(band, wl, curve):
        return curve * (1 + a * np.clip((wl - 1.08e-6) / 0.04e-6, 0.0, 1.0))

    return _response(scene, change)


def _clock(scene, a, shape, gas):
    return replace(scene, pyrometer_delay=scene.pyrometer_delay + a)


# ---- the spectrometer ------------------------------------------------------------------------------------


def _dark_counts(scene, a, shape, gas):
    """Extra counts in all pixels, as a share of the mean of the gas in the reference window."""
    first, last = scene.reference_window

    def change(rate, time):
        return rate + a * rate[(time >= first) & (time <= last)].mean()

    return _spectrometer(scene, change)


def _compressed_counts(scene, a, shape, gas):
    return _spectrometer(scene, lambda rate, time: rate * (1 - a * rate / rate.max()))


def _shift(scene, a, shape, gas):
    return replace(scene, pixel_shift=scene.pixel_shift + a * NANOMETRE)


def _wider_slit(scene, a, shape, gas):
    fwhm = scene.true_fwhm or scene.spectrometer.fwhm
    return replace(scene, true_fwhm=np.hypot(fwhm, np.sqrt(8 * np.log(2)) * a * NANOMETRE))


def _stray(scene, a, shape, gas):
    return _spectrometer(scene, lambda rate, time: (1 - a) * rate + a * rate.mean(axis=1, keepdims=True))


def _second_order(scene, a, shape, gas):
    """Light of half the wavelength, let through by the filter above 455 nm, from 910 nm on."""
    nitrogen_ion = gas.radiance[gas.systems.index("N2+ Meinel")].mean()
    spectrum = np.zeros(gas.centres.size)
    for place, strength, tail in lines.SECOND_ORDER:
        spectrum += heads(gas.centres, [2 * place], [strength], 2 * tail, red=False)
    # ASSUME: the first negative system is as bright as the Meinel system; only the shape carries information.
    spectrum *= nitrogen_ion / (spectrum[gas.centres > 910e-9].mean())
    opening = 1 / (1 + np.exp(-(gas.centres - 915e-9) / 4e-9))

    def share(s):
        return s.scale if s.instrument == "spectrometer" else 0.0 * s.scale

    def hot_surface(instrument, wl, time, kelvin):
        if instrument != "spectrometer":
            return 0.0
        surface = scene.surface_emittance(wl, kelvin, time) * planck(wl / 2, kelvin)
        return np.where(time >= 0, a * surface, 0.0) / (1 + np.exp(-(wl - 915e-9) / 4e-9))

    return _add_light(_add_plume(scene, gas, a * opening * spectrum, share), hot_surface)


# ---- outside the catalogue -------------------------------------------------------------------------------


def _etalon(scene, a, shape, gas):
    """Fringes of a thin layer: periodic in 1 / wavelength, the same in all frames."""
    pixels = scene.spectrometer.wavelength
    path = 0.9e-6**2 / (shape["period_nm"] * NANOMETRE)
    fringe = np.sin(2 * np.pi * path / pixels + shape["phase"])
    return _spectrometer(scene, lambda rate, time: rate * (1 + a * fringe))


def _fibre_step(scene, a, shape, gas):
    step = shape["at_s"]
    return _window(scene, "spectrometer", lambda wl, time: np.where(time > step, 1 - a, 1.0))


def _fibre_wave(scene, a, shape, gas):
    return _window(
        scene, "spectrometer", lambda wl, time: 1 + a * np.sin(2 * np.pi * time / 37.0 + shape["phase"])
    )


def _band_in_emittance(scene, a, shape, gas):
    centre, sigma = shape["centre_nm"] * NANOMETRE, shape["sigma_nm"] * NANOMETRE

    def factor(wl, kelvin, time):
        grown = -np.expm1(-np.maximum(time, 0) / shape["tau_s"])
        return 1 + a * grown * np.exp(-(((wl - centre) / sigma) ** 2) / 2)

    return _emittance(scene, factor)


def _channel_drift(scene, a, shape, gas):
    """The narrow channel warms up for minutes."""

    def change(clean, time):
        warm = -np.expm1(-np.maximum(time, 0) / shape["tau_s"])
        return clean * np.stack([np.ones_like(warm), 1 + a * warm])

    return _pyrometer(scene, change)


CATALOGUE = {
    "refl": Hidden(_reflection, 1.0, 0.0, 1.5, {"diffuse": (0.0, 0.1)}),
    "eps_slope": Hidden(_slope, 0.3, -0.6, 0.6),
    "eps_T": Hidden(_with_temperature, 0.05, -0.2, 0.15),
    "eps_ox": Hidden(_oxidation, 0.05, -0.3, 0.15, {"tau_s": (10.0, 200.0)}),
    "winD": Hidden(partial(_deposit, "pyrometer"), 0.05, 0.0, 0.4),
    "winE": Hidden(partial(_deposit, "spectrometer"), 0.05, 0.0, 0.4),
    "winD_sl": Hidden(partial(_blue_deposit, "pyrometer"), 0.05, 0.0, 0.3, {"power": (1.0, 4.0)}),
    "winE_sl": Hidden(partial(_blue_deposit, "spectrometer"), 0.05, 0.0, 0.3, {"power": (1.0, 4.0)}),
    "off1": Hidden(partial(_offset, 0), 0.1, -0.3, 0.3),
    "off2": Hidden(partial(_offset, 1), 0.1, -0.3, 0.3),
    "off_s": Hidden(_dark_counts, 0.1, -0.3, 0.3),
    "torchglow": Hidden(_torch_glow, 0.003, 0.0, 0.03, {"glow_k": (800.0, 1600.0), "decay_s": (5.0, 60.0)}),
    "nonlin_p": Hidden(_compressed_signal, 0.02, -0.1, 0.1),
    "nonlin_s": Hidden(_compressed_counts, 0.02, -0.1, 0.1),
    "phi": Hidden(_ratio, 0.02, -0.1, 0.1),
    "edge1": Hidden(partial(_edge, "wide"), 5.0, -15.0, 15.0),
    "edge2": Hidden(partial(_edge, "narrow"), 5.0, -15.0, 15.0),
    "resp_long": Hidden(_tail, 0.1, -0.4, 0.4),
    "wshift": Hidden(_shift, 0.5, -1.0, 1.0),
    "lsf": Hidden(_wider_slit, 0.2, 0.0, 0.5),
    "stray": Hidden(_stray, 0.005, 0.0, 0.1),
    "second": Hidden(_second_order, 0.5, 0.0, 3.0),
    "P_eff": Hidden(partial(_other_spectrum, lambda gas, a: gas.hotter(a)), 0.05, -0.12, 0.12),
    "T_exc": Hidden(partial(_other_spectrum, lambda gas, a: gas.excited(1 + a)), 0.03, -0.12, 0.12),
    "T_vib": Hidden(partial(_other_spectrum, lambda gas, a: gas.vibrating(1 + a)), 0.1, -0.4, 0.5),
    "ripple": Hidden(partial(_other_spectrum, lambda gas, a: gas.rippled(a)), 0.05, 0.0, 0.2),
    "selfabs": Hidden(partial(_other_spectrum, lambda gas, a: gas.self_absorbed(a)), 0.3, 0.0, 2.0),
    "contin": Hidden(_continuum, 1.0, 0.0, 5.0),
    "gas_drift": Hidden(_drift, 0.1, -0.3, 0.3),
    "bl": Hidden(_warm_layer, 1.0, 0.0, 5.0),
    "afterglow": Hidden(_afterglow, 0.1, 0.0, 0.5, {"decay_s": (0.3, 5.0)}),
    "particles": Hidden(_particles, 2e-4, 0.0, 5e-3, {"grain_k": (2100.0, 2500.0), "pattern": (0, 1e6)}),
    "NaK": Hidden(partial(_line_light, lines.SODIUM_POTASSIUM, 0.05, True), 0.3, 0.0, 10.0),
    "CaII": Hidden(partial(_line_light, lines.CALCIUM_ION, 0.05, True), 0.3, 0.0, 10.0),
    "CN": Hidden(_cyanogen, 3.0, 0.0, 50.0),
    "Cu": Hidden(partial(_line_light, lines.COPPER, 0.02, False), 0.3, 0.0, 10.0),
    "Ar": Hidden(_argon, 0.3, 0.0, 10.0),
    "h2o": Hidden(_water, 0.02, -0.1, 0.1),
    "o2a": Hidden(_oxygen, 0.02, -0.1, 0.1),
    "grad": Hidden(_spread, 60.0, 0.0, 150.0, {"spot_ratio": (0.45, 0.75)}),
    "edge_p": Hidden(
        partial(_cover, "pyrometer"), 0.05, 0.0, 0.3, {"ratio": (0.7, 0.9), "lag_s": (2.0, 15.0)}
    ),
    "edge_s": Hidden(
        partial(_cover, "spectrometer"), 0.05, 0.0, 0.3, {"ratio": (0.7, 0.9), "lag_s": (2.0, 15.0)}
    ),
    "clock": Hidden(_clock, 0.5, -2.0, 2.0),
    "scat": Hidden(_scattering, 0.01, 0.0, 0.2),
}
OUTSIDE = {
    "etalon": Hidden(_etalon, 0.01, 0.0, 0.2, {"period_nm": (4.0, 10.0), "phase": (0.0, 6.28)}),
    "fibre_step": Hidden(_fibre_step, 0.02, -0.3, 0.3, {"at_s": (50.0, 260.0)}),
    "fibre_wave": Hidden(_fibre_wave, 0.02, 0.0, 0.2, {"phase": (0.0, 6.28)}),
    "rubidium": Hidden(partial(_line_light, lines.RUBIDIUM, 0.02, True), 0.3, 0.0, 10.0),
    "emittance_band": Hidden(
        _band_in_emittance,
        0.03,
        -0.2,
        0.15,
        {"centre_nm": (780.0, 1000.0), "sigma_nm": (10.0, 60.0), "tau_s": (5.0, 60.0)},
    ),
    "channel_drift": Hidden(_channel_drift, 0.02, -0.1, 0.1, {"tau_s": (60.0, 200.0)}),
}
EFFECTS = CATALOGUE | OUTSIDE


def fault_of(effect: str, amplitude: float, shape: dict | None = None) -> str:
    """What is wrong with an effect that is to be hidden, in words; empty if nothing is."""
    if effect not in EFFECTS:
        near = get_close_matches(effect, EFFECTS, n=1)
        meant = f"; did you mean '{near[0]}'?" if near else ""
        return f"effect must be one of {', '.join(EFFECTS)}; got {effect!r}{meant}"
    entry = EFFECTS[effect]
    if not entry.low <= amplitude <= entry.high:
        return f"{effect}: amplitude must lie in [{entry.low:g}, {entry.high:g}]; got {amplitude:g}"
    unknown = set(shape or {}) - set(entry.shape)
    if unknown:
        has = f"it has {', '.join(entry.shape)}" if entry.shape else "it takes none"
        return f"{effect}: shape has no {', '.join(sorted(unknown))}; {has}"
    return ""


def hide(scene: Scene, effect: str, amplitude: float, gas: Gas, shape: dict | None = None) -> Scene:
    """The scene with one more effect, written into its `hidden` list.

    ValueError: unknown effect or shape, or an amplitude beyond what is sensible.
    """
    fault = fault_of(effect, amplitude, shape)
    if fault:
        raise ValueError(fault)
    entry = EFFECTS[effect]
    shape = entry.middle() | (shape or {})
    changed = entry.apply(scene, amplitude, shape, gas)
    note = {"effect": effect, "amplitude": amplitude, "shape": shape}
    return replace(changed, hidden=(*scene.hidden, note))
