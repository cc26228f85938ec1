"""Effects of the surface: its emittance, its temperature over the spot, what it reflects."""

import numpy as np

from plasmapyro.diagnosis.effects.effect import effect
from plasmapyro.radiation.planck import planck

PIVOT = 0.95e-6  # [m] where spectral slopes turn
MICROMETRE = 1e-6
HOTTEST, COLD = 1600.0, 350.0  # [K] between which a dependence on temperature is counted
COLDEST, COLDEST_SHARE = 60.0, 1 / 3  # [K], and of the mean: no point of the rule lies lower, and it is dark
FOOTPRINT_RATIO = 10.0 / 14.0  # diameter of the spot of the spectrometer over that of the pyrometer
LAGS, SHARES = np.polynomial.laguerre.laggauss(4)
COVER_EMITTANCE = 1.0  # ASSUME: the cover of the probe emits like the sample


@effect("eps_slope")
def slope(scene, amplitude):
    r"""Emittance that varies with wavelength: :math:`\varepsilon[1 + b(\lambda - 0.95\,\mu m)]`."""
    return scene.but(emittance=scene.emittance * (1 + amplitude * (scene.wavelength - PIVOT) / MICROMETRE))


@effect("eps_T")
def with_temperature(scene, amplitude):
    r"""Emittance that follows the temperature: :math:`\varepsilon[1 + c (T - 350)/1250]`."""
    change = (scene.temperature[..., None] - COLD) / (HOTTEST - COLD)
    return scene.but(emittance=scene.emittance * (1 + amplitude * change))


@effect("eps_ox", shape={"time_constant": ((10.0, 40.0, 150.0), (3.0, 400.0))})
def oxidation(scene, amplitude, *, time_constant):
    r"""Emittance that changes for good: :math:`\varepsilon[1 + a(1 - e^{-t/\tau})]`."""
    grown = -np.expm1(-np.maximum(scene.time, 0.0) / time_constant)[..., None]
    return scene.but(emittance=scene.emittance * (1 + amplitude * grown))


@effect("refl", shape={"contrast": ((1.0,), (0.6, 1.4))})
def reflection(scene, amplitude, *, contrast):
    r"""Light of the gas that the surface scatters: :math:`(1 - \varepsilon) a R (r/R)^q` of what there is.

    A matt surface scatters r of it, R of all, as simulated; `contrast` q is how much more of that are the
    lines of hot gas. What a mirror returns is the light of the sight line, as if the gas were brighter.
    """
    base, matt = scene.library.base, scene.library.addition["reflected_diffuse"]
    mean = matt.sum() / base.sum()
    dark = 1 - np.asarray(scene.emittance)
    dark = dark if dark.ndim == 0 else np.broadcast_to(dark, scene.glow.shape).mean(axis=-1)
    share = amplitude * dark * scene.gas_gain * scene.injected
    spectrum = scene.spectrum * mean * (matt / base / mean) ** contrast
    return scene.but(scattered=(*scene.scattered, (share, spectrum)))


@effect(
    "torchglow",
    shape={"temperature": ((850.0, 1200.0, 1550.0), (700.0, 1800.0)), "decay": ((8.0, 40.0), (2.0, 100.0))},
)
def torch_glow(scene, amplitude, *, temperature, decay):
    r"""Reflected glow of hot walls: :math:`(1-\varepsilon) c B(T_q)`, fading after the plasma ends."""
    after = np.maximum(scene.time - scene.off_time, 0.0)
    share = amplitude * scene.injected * np.exp(-after / decay)
    body = planck(scene.wavelength, np.array(temperature))
    return scene.but(added=scene.added + (1 - scene.emittance) * share[..., None] * body)


@effect("grad", shape={"exponent": ((0.0, 1.0), (0.0, 1.0)), "profile": ((0.0, 1.0, 2.0), (-1.0, 2.0))})
def gradient(scene, amplitude, *, exponent, profile=1.0):
    r"""Unequal temperature, a slope over a disc: mean of B over the law of a semicircle.

    .. math:: \tfrac14 B(T - \sqrt2 \sigma) + \tfrac12 B(T) + \tfrac14 B(T + \sqrt2 \sigma), \qquad
              \sigma = \sigma_T (T/1600\,K)^n

    `exponent` n is 1 where the flux is uneven, 0 where a lasting difference is; `profile` 1 for a slope over
    the spot and 2 for a bowl: spots 14 and 10 mm across see that power of their ratio; 0 where both see the
    same, less where the spectrometer sees more. One instrument alone does not tell it from the amplitude.

    Source: Gauss's rule of three points for that law, exact to the fifth order; M. Abramowitz and I. A.
    Stegun, Handbook of Mathematical Functions (1964), 25.4.40.
    """
    relative = np.clip(scene.temperature / HOTTEST, 0.1, 2.0) ** exponent
    sigma = amplitude * (FOOTPRINT_RATIO**profile if scene.kind == "spectrometer" else 1.0) * relative
    apart = np.minimum(np.sqrt(2.0) * sigma, scene.temperature * (1 - COLDEST_SHARE))
    cold, mean, hot = (
        planck(scene.wavelength, np.maximum(scene.temperature + sign * apart, COLDEST)) for sign in (-1, 0, 1)
    )
    return scene.but(glow=scene.glow * (0.5 + 0.25 * (cold + hot) / mean))


def cover(scene, amplitude, *, ratio, lag, delay):
    r"""A share of the spot falls beside the sample, on something cooler that follows it.

    .. math:: T' = T_0 + r \int_0^\infty (T(t - \tau [d + (1 - d) x]) - T_0)\,e^{-x}\,dx

    by Gauss and Laguerre's quadrature: `lag` :math:`\tau` later in the mean, a share `delay` d of it by a
    dead time, the rest by a time constant, as heat that is conducted into it arrives late and spread.

    Source: the three-parameter model of K. J. Astrom & T. Hagglund, PID Controllers (1995).
    """
    late = lag * (delay + (1 - delay) * LAGS)
    behind = scene.history(np.maximum(scene.time[..., None] - late, 0.0)) @ SHARES
    other = COLD + ratio * (np.where(scene.time > 0, behind, COLD) - COLD)
    body = planck(scene.wavelength, np.maximum(other, 250.0)) * scene.injected[..., None]
    return scene.but(glow=scene.glow + amplitude * (COVER_EMITTANCE * body - scene.glow))


EDGE = {
    "ratio": ((0.8,), (0.5, 0.98)),
    "lag": ((1.0, 6.0), (0.2, 30.0)),
    "delay": ((0.0, 1.0), (0.0, 1.0)),
}
cover_pyrometer = effect("edge_p", shape=EDGE)(cover)
cover_spectrometer = effect("edge_s", shape=EDGE)(cover)
