"""Terms of the surface: its emittance, its temperature over the spot, what it reflects."""

import numpy as np

from plasmapyro.diagnosis.scene import planck, planck_curvature

PIVOT = 0.95e-6  # [m] where spectral slopes turn
MICROMETRE = 1e-6
HOT, COLD = 1600.0, 350.0  # [K] between which a dependence on temperature is counted
FOOTPRINT_RATIO = 10.0 / 14.0  # diameter of the spot of the spectrometer over that of the pyrometer
COVER_EMITTANCE = 1.0  # ASSUME: the cover of the probe emits like the sample


def slope(scene, amplitude):
    r"""Emittance that varies with wavelength: :math:`\varepsilon[1 + b(\lambda - 0.95\,\mu m)]`."""
    return scene.but(emittance=scene.emittance * (1 + amplitude * (scene.wavelength - PIVOT) / MICROMETRE))


def with_temperature(scene, amplitude):
    r"""Emittance that follows the temperature: :math:`\varepsilon[1 + c (T - 350)/1250]`."""
    change = (scene.temperature[..., None] - COLD) / (HOT - COLD)
    return scene.but(emittance=scene.emittance * (1 + amplitude * change))


def oxidation(scene, amplitude, *, time_constant):
    r"""Emittance that changes for good: :math:`\varepsilon[1 + a(1 - e^{-t/\tau})]`."""
    grown = -np.expm1(-np.maximum(scene.time, 0.0) / time_constant)[..., None]
    return scene.but(emittance=scene.emittance * (1 + amplitude * grown))


def reflection(scene, amplitude, *, diffuse):
    r"""Light of the gas that the surface reflects: :math:`(1 - \varepsilon) f L^{gs}`.

    `diffuse` shares it between what a mirror and what a matt surface returns.
    """
    library = scene.library
    one = library.addition["reflected_specular"] / library.base
    two = library.addition["reflected_diffuse"] / library.base
    spectrum = scene.spectrum * ((1 - diffuse) * one + diffuse * two)
    dark = 1 - np.asarray(scene.emittance)
    mean = dark if dark.ndim == 0 else np.broadcast_to(dark, scene.glow.shape).mean(axis=-1)
    share = amplitude * mean * scene.gas_gain * scene.injected
    return scene.but(more_gas=(*scene.more_gas, (share, spectrum)))


def torch_glow(scene, amplitude, *, temperature, decay):
    r"""Reflected glow of hot walls: :math:`(1-\varepsilon) c B(T_q)`, fading after the plasma ends."""
    after = np.maximum(scene.time - scene.off_time, 0.0)
    share = amplitude * scene.injected * np.exp(-after / decay)
    body = planck(scene.wavelength, np.array(temperature))
    return scene.but(added=scene.added + (1 - scene.emittance) * share[..., None] * body)


def gradient(scene, amplitude):
    r"""Unequal temperature over the spot: :math:`B + \tfrac12 \sigma_T^2 B''`; amplitude :math:`\sigma_T`
    [K].

    ASSUME: the standard deviation goes with the area of the spot, 14 and 10 mm across.
    """
    sigma = amplitude * (FOOTPRINT_RATIO**2 if scene.kind == "spectrometer" else 1.0)
    relative = np.clip(scene.temperature[..., None] / HOT, 0.0, 2.0)
    more = 0.5 * (sigma * relative) ** 2 * planck_curvature(scene.wavelength, scene.temperature)
    return scene.but(glow=scene.glow * (1 + more))


def _cover(kind):
    def cover(scene, amplitude, *, ratio, lag):
        """A share of the spot falls beside the sample, on something cooler that lags behind."""
        if scene.kind != kind:
            return scene
        behind = scene.history(np.maximum(scene.time - lag, 0.0))
        other = COLD + ratio * (np.where(scene.time > 0, behind, COLD) - COLD)
        body = planck(scene.wavelength, np.maximum(other, 250.0)) * scene.injected[..., None]
        return scene.but(glow=scene.glow + amplitude * (COVER_EMITTANCE * body - scene.glow))

    return cover


cover_pyrometer, cover_spectrometer = _cover("pyrometer"), _cover("spectrometer")
