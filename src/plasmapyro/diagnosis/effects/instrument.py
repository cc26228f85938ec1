"""Effects of the instruments: optics, detectors, clocks."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.effects.effect import effect
from plasmapyro.radiation.planck import planck

NANOMETRE = 1e-9
SECOND_ORDER = (  # [nm] in the first order, strength, tail to the blue: what would appear twice as far
    (470.9, 1.0, 3.0),  # N2+ 1-, 0-2
    (465.2, 0.5, 3.0),  # N2+ 1-, 1-3
    (486.1, 0.3, 0.1),  # H beta
    (493.5, 0.2, 0.1),  # N I
)


def shifted_response(band):
    """Formula of the response of a band moved along the wavelength, amplitude in nm: its short-wave flank,
    which a filter makes, and its fall to long waves, the detector's, by the share `detector` of that."""

    def shift(scene, amplitude, *, detector):
        x = amplitude * NANOMETRE
        flank, end = list(scene.response_shift), list(scene.detector_shift)
        flank[band] += x
        end[band] += (detector - 1) * x
        return scene.but(response_shift=tuple(flank), detector_shift=tuple(end))

    return shift


DETECTOR = {"detector": ((1.0, 0.0), (0.0, 1.0))}
wide_edges = effect("edge1", shape=DETECTOR)(shifted_response(0))
narrow_edges = effect("edge2", shape=DETECTOR)(shifted_response(1))


@effect("resp_long")
def response_tail(scene, amplitude):
    """Both responses multiplied by a factor that grows from 1.05 um to 1 + a at 1.13 um: warmer silicon."""
    return scene.but(response_tail=scene.response_tail + amplitude)


@effect("wshift")
def wavelength_shift(scene, amplitude):
    """The spectrometer reads each wavelength where another belongs, amplitude in nm: gas and surface move."""
    x = amplitude * NANOMETRE
    slope = np.gradient(scene.glow, scene.wavelength, axis=-1)
    return scene.but(wavelength_shift=scene.wavelength_shift + x, glow=scene.glow + x * slope)


@effect("lsf")
def wider_slit(scene, amplitude):
    """A wider slit function: standard deviation `amplitude` [nm] added in quadrature."""
    change = np.sign(amplitude) * (amplitude * NANOMETRE) ** 2
    return scene.but(slit_sigma2=scene.slit_sigma2 + change)


@effect("second")
def second_order(scene, amplitude):
    """Light of half the wavelength in the second order of the grating, beyond 910 nm.

    ASSUME: positions are those of N2+ 1- heads (Gilmore, Laher & Espy 1992), H beta and N I; their strengths,
    outside the range of the engine, are guesses: 1 makes the strongest image as bright as the gas beside it.
    """
    axis = scene.spectral_axis
    image = np.zeros(axis.size)
    level = scene.library.base[(axis > 930e-9) & (axis < 960e-9)].mean()
    for place, strength, tail in SECOND_ORDER:
        away = 2 * place * 1e-9 - axis
        width = max(2 * tail * 1e-9, 0.6e-9)
        shape = np.where(away >= 0, np.exp(-np.maximum(away, 0) / width), np.exp(-((away / 0.4e-9) ** 2)))
        image += strength * shape
    image *= level / (1 + np.exp(-(axis - 915e-9) / 4e-9))
    opening = 1 / (1 + np.exp(-(scene.wavelength - 915e-9) / 4e-9))
    hot = planck(scene.wavelength / 2, scene.temperature) * scene.injected[..., None] * opening
    return scene.but(
        more_gas=(*scene.more_gas, (amplitude * scene.gas_gain, image)),
        added=scene.added + amplitude * scene.emittance * hot,
    )


@effect("phi")
def ratio(output, amplitude):
    r"""Error of the ratio of sensitivities: :math:`\varphi e^d`."""
    return output.value * np.exp(amplitude * np.array([1.0, 0.0]))


def offset(band):
    """Formula of a constant on a band, in units of the signal of the gas."""

    def raised(output, amplitude):
        extra = np.zeros(2)
        extra[band] = output.gas_level[band]
        return output.value + amplitude * extra

    return raised


wide_offset = effect("off1")(offset(0))
narrow_offset = effect("off2")(offset(1))


@effect("off_s")
def dark_counts(output, amplitude):
    """The same extra count rate in all pixels, in units of the mean of the gas."""
    level = np.average(output.gas_level / output.factor, weights=output.pixels)
    return output.value + amplitude * level * output.factor


@effect("stray")
def stray(output, amplitude):
    """Stray light: every pixel gets a share of the mean count rate of all."""
    mean = np.average(output.value / output.factor, axis=1, weights=output.pixels)[:, None]
    return (1 - amplitude) * output.value + amplitude * mean * output.factor


@effect("crosstalk")
def crosstalk(output, amplitude):
    r"""Bands of one detector, each with a share of the mean signal of all as recorded:
    :math:`(1 - a) S_i + a \bar S`."""
    return (1 - amplitude) * output.value + amplitude * output.value.mean(axis=1, keepdims=True)


@effect("nonlin_p")
def compressed_signal(output, amplitude):
    r"""Nonlinear detector: :math:`S (1 - a S/S_{max})`."""
    return output.value * (1 - amplitude * output.value / output.full_scale)


@effect("nonlin_s")
def compressed_counts(output, amplitude):
    r"""Nonlinear converter: :math:`U (1 - a U/U_{max})` in counts."""
    return output.value * (1 - amplitude * (output.value / output.factor) / output.full_scale)


@effect("clock")
def clocks_apart(amplitude, kind, *, spectra=0.0):
    """Shift of time [s] of a kind of instrument: the clock of the pyrometer is early against the spectra, or,
    by the share `spectra`, these are late, and pyrometer and end of the plasma stay where they are."""
    return amplitude * (1 - spectra if kind == "pyrometer" else -spectra)


clocks_apart = replace(clocks_apart, shape_bounds={"spectra": (0.0, 1.0)}, starts=({"spectra": 1.0},))
