"""Stage files of the gas, put together as one library of templates."""

import numpy as np

from plasmapyro.diagnosis.templates import GasLibrary, extra_sigma, line_groups, widened


def gas_library(condition, radiation, powers, variations, *, fwhm):
    """Templates of the gas for one test.

    Parameters
    ----------
    condition : str
        Simulation to compare with.
    radiation : mapping condition -> Dataset, contract 'radiation'
    powers : mapping condition -> float [W]
    variations : Dataset, contract 'gas_variations', of the condition, or None
    fwhm : float [m]
        Slit of the spectrometer. A narrower one than that of the library is taken as that of the library.

    Returns
    -------
    GasLibrary

    Raises
    ------
    ValueError
        Unknown condition, or spectra that are not on the same axis.
    """
    if condition not in radiation:
        raise ValueError(f"condition must be among {', '.join(radiation)}; got {condition!r}")
    own = radiation[condition]
    axis, slit = own["wavelength_slit"].values, float(own.attrs["slit_fwhm"])
    names = sorted((name for name in radiation if name in powers), key=lambda name: powers[name])
    others = [*radiation.items()] + ([("variations", variations)] if variations is not None else [])
    for name, other in others:
        if not np.array_equal(other["wavelength_slit"].values, axis):
            raise ValueError(f"the spectra of {name} and {condition} are not on the same wavelengths")
    sigma = extra_sigma(fwhm, slit)

    def seen(values):
        return np.maximum(widened(axis, values, sigma), 1e-9 * values.max())

    groups, light = line_groups(
        axis, own["component"].values.astype(str), own["gas_radiance_component_slit"].values
    )
    return GasLibrary(
        condition=condition,
        power=float(powers[condition]),
        wavelength=axis,
        slit_fwhm=max(fwhm, slit),
        log_power=np.log([powers[name] for name in names]),
        radiance=np.array([seen(radiation[name]["gas_radiance_slit"].values) for name in names]),
        group_name=groups,
        group=widened(axis, light, sigma),
        variation=_variations(variations, seen),
        addition=_additions(variations, axis, sigma),
        weakest=seen(radiation[names[0]]["gas_radiance_slit"].values),
        core=None
        if variations is None
        else (
            variations["core_change"].values,
            np.array([seen(row) for row in variations["core_radiance"].values]),
        ),
    )


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


def _additions(variations, axis, sigma):
    if variations is None:
        return {}
    return {
        str(name): widened(axis, variations["added_radiance"].sel(addition=name).values, sigma)
        for name in variations["addition"].values
    }
