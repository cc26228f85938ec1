"""Stage files of the gas, put together as one library of templates."""

import numpy as np
from scipy.interpolate import CubicSpline

from plasmapyro import conditions
from plasmapyro.diagnosis.gas.templates import (
    CHANGED,
    WARMTH_OF_POWER,
    GasLibrary,
    extra_sigma,
    line_groups,
    widened,
)
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.radiation.uncertainty import LEAST_STRENGTH, STRENGTHS

OF_POSITION = 2e-5  # [1] ASSUME of a wavelength: Stark shifts, and a scale that warms by a kelvin (0.02 nm)
DEPTH = "optical_depth_simulated"  # attribute of the variations
OF_SLIT = 0.05  # [1] ASSUME of the square of the width of the slit: 2.5 % of its width, or another shape


def gas_library(condition, radiation, variations, *, fwhm):
    """Templates of the gas for one test, that of a simulated condition.

    `radiation`: condition -> Dataset; those that share all but the power with it, and its slit, say what
    another power does. `variations` of the condition, or None; `fwhm` [m]: slit of the spectrometer. A
    narrower one than that of the library is taken as that of the library. ValueError: unknown condition, or
    varied spectra that are not on its axis.
    """
    if condition not in radiation:
        raise ValueError(f"condition must be among {', '.join(radiation)}; got {condition!r}")
    own = radiation[condition]
    axis, slit = own["wavelength_slit"].values, float(own.attrs["slit_fwhm"])
    if variations is not None and not np.array_equal(variations["wavelength_slit"].values, axis):
        raise ValueError(f"the varied spectra of {condition} are not on the wavelengths of its spectrum")
    sigma = extra_sigma(fwhm, slit)

    def seen(values):
        return np.maximum(widened(axis, values, sigma), 1e-9 * values.max())

    components = own["component"].values.astype(str), own["gas_radiance_component_slit"].values
    groups, light = line_groups(axis, *components)
    (systems, causes, strength), (shape_systems, shape_causes, shape) = _error_modes(own)
    of_scale, scale = _of_scale(axis, *components, max(fwhm, slit))
    names = rungs(condition, radiation)
    return GasLibrary(
        condition=condition,
        power=conditions.number(own, conditions.POWER),
        wavelength=axis,
        slit_fwhm=max(fwhm, slit),
        log_power=np.log([conditions.number(radiation[name], conditions.POWER) for name in names]),
        radiance=np.array([seen(radiation[name]["gas_radiance_slit"].values) for name in names]),
        group_name=groups,
        group=widened(axis, light, sigma),
        variation=_variations(variations, seen),
        share={} if variations is None else _shares([radiation[name] for name in names], axis, sigma),
        addition=_additions(variations, axis, sigma),
        systems=systems,
        strength_modes=widened(axis, strength, sigma),
        shape_systems=(*shape_systems, *of_scale),
        causes=causes,
        shape_causes=(*shape_causes, *[""] * len(scale)),
        shape_modes=widened(axis, np.concatenate([shape, scale]), sigma),
        bands=widened(axis, _of_bands(own), sigma),
        weakest=seen(radiation[names[0]]["gas_radiance_slit"].values),
        depth=np.nan if variations is None else variations.attrs.get(DEPTH, np.nan),
        core=None
        if variations is None
        else (
            variations["core_change"].values,
            np.array([seen(row) for row in variations["core_radiance"].values]),
        ),
    )


def _error_modes(radiation):
    """Errors of a spectrum in strengths, and in shapes: systems (M,), causes (M,) and modes (M, K) of each.

    Spectra that do not state modes err in the strengths of their systems alone.
    """
    component = radiation["component"].values.astype(str)
    light = radiation["gas_radiance_component_slit"].values
    if "error_share" not in radiation:
        shines = light.any(axis=1)
        size = np.maximum(radiation["component_uncertainty"].values[shines], LEAST_STRENGTH)
        strength = tuple(component[shines]), ("strength",) * int(shines.sum()), size[:, None] * light[shines]
        return strength, ((), (), np.zeros((0, light.shape[1])))
    system, cause = (radiation[name].values.astype(str) for name in ("error_system", "error_cause"))
    place = [list(component).index(name) for name in system]
    modes = radiation["error_share"].values * light[place]
    strength = np.isin(cause, STRENGTHS)
    return tuple((tuple(system[kind]), tuple(cause[kind]), modes[kind]) for kind in (strength, ~strength))


def _of_bands(radiation):
    """Light (K,) of the systems whose spectrum states an error of its rotational structure."""
    if "error_share" not in radiation:
        return np.zeros(radiation["wavelength_slit"].size)
    cause, system = (radiation[name].values.astype(str) for name in ("error_cause", "error_system"))
    rotating = np.isin(radiation["component"].values.astype(str), system[cause == "rotation"])
    return radiation["gas_radiance_component_slit"].values[rotating].sum(axis=0)


def _of_scale(wavelength, component, radiance, fwhm):
    """What lines do to a spectrum (C, K) of components whose wavelengths or slit [m] are not quite as stated:
    systems (M,), "" for all, and modes (M, K). All are moved, along a polynomial as dispersion has, all are
    widened, and those of each component are moved by themselves: levels have errors of their own."""
    across = np.linspace(-1, 1, wavelength.size)
    slope = _slope(wavelength, np.vstack([radiance.sum(axis=0), radiance]))
    moved = OF_POSITION * wavelength * slope
    bent = moved[0] * np.array([across**0, across, (3 * across**2 - 1) / 2])
    wider = OF_SLIT * (fwhm / FWHM_PER_SIGMA) ** 2 / 2 * _slope(wavelength, slope[:1])
    return ("",) * 4 + tuple(component), np.vstack([bent, wider, moved[1:]])


def _slope(wavelength, rows):
    """Derivative of rows (M, K) by splines: of lines five steps wide differences of neighbours are 4 % too
    small, many times the noise of a line."""
    return CubicSpline(wavelength, rows, axis=1)(wavelength, 1)


def rungs(condition, radiation):
    """Conditions that share all but the power with one of them, itself among them, and its slit; by power."""
    own = radiation[condition]
    same = {
        name: one
        for name, one in radiation.items()
        if np.array_equal(one["wavelength_slit"].values, own["wavelength_slit"].values)
        and one.attrs["slit_fwhm"] == own.attrs["slit_fwhm"]
    }
    return conditions.ladder(condition, same)


def remarks(condition, radiation, variations):
    """What the simulations at hand leave out, in sentences for the report; arguments as of `gas_library`."""
    alone = len(rungs(condition, radiation)) == 1
    reason = (
        f"{condition} does not state its power"
        if np.isnan(conditions.number(radiation[condition], conditions.POWER))
        else f"no other simulation shares all but the power with {condition}"
    )
    said = []
    if alone and variations is not None:
        said.append(
            f"{reason}: another power is taken as gas that is hotter or colder by {WARMTH_OF_POWER:g} of its"
            " relative change"
        )
    elif alone:
        said.append(f"{reason}: another power changes the brightness of the gas, not its spectrum")
    if variations is None:
        said.append(
            f"no varied spectra of {condition} are at hand: effects that need them are left out"
            " (power, ripple, temperatures of excitation and vibration, self-absorption, reflection, boundary"
            " layer, CN)"
        )
    return said


def _variations(variations, seen):
    if variations is None:
        return {}
    return {
        str(name): (
            variations["variation_amplitude"].sel(variation=name).values,
            seen(variations["varied_radiance"].sel(variation=name).values),
        )
        for name in variations["variation"].values
    }


def _shares(rungs, axis, sigma):
    """Shares (C, K) of the light of some spectra, of the systems that each variation changes."""
    found = {}
    for name, systems in CHANGED.items():
        rows = []
        for one in rungs:
            light = widened(axis, one["gas_radiance_component_slit"].values, sigma)
            own = np.isin(one["component"].values.astype(str), systems)
            rows.append(light[own].sum(axis=0) / np.maximum(light.sum(axis=0), 1e-300))
        found[name] = np.array(rows)
    return found


def _additions(variations, axis, sigma):
    if variations is None:
        return {}
    return {
        str(name): widened(axis, variations["added_radiance"].sel(addition=name).values, sigma)
        for name in variations["addition"].values
    }
