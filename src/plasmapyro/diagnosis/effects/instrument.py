"""Effects of the instruments: optics, detectors, clocks."""

from functools import partial

import numpy as np

from plasmapyro.diagnosis.effects.effect import (
    BURNING,
    HOT,
    PAPER,
    PHASES,
    PYROMETER,
    SPECTROMETER,
    Amplitude,
    effect,
)
from plasmapyro.radiation.planck import planck

NANOMETRE = 1e-9
CALIBRATE_AGAIN = "the blackbody calibration repeated after the test, through the window"
SECOND_ORDER = (  # [nm] in the first order, strength, tail to the blue: what would appear twice as far
    (470.9, 1.0, 3.0),  # N2+ 1-, 0-2
    (465.2, 0.5, 3.0),  # N2+ 1-, 1-3
    (486.1, 0.3, 0.1),  # H beta
    (493.5, 0.2, 0.1),  # N I
)

optics = partial(effect, stage="optics")
responses = partial(optics, klass="responses of the pyrometer", phases=HOT, instruments=PYROMETER)


def shifted_response(band):
    """Formula of the response of a band moved along the wavelength, amplitude in nm."""

    def shift(scene, amplitude):
        moved = list(scene.response_shift)
        moved[band] += amplitude * NANOMETRE
        return scene.but(response_shift=tuple(moved))

    return shift


edges = partial(
    responses,
    amplitude=Amplitude("shift", "nm", sigma=6.0, bounds=(-25.0, 25.0)),
    measurement=CALIBRATE_AGAIN,
)
wide_edges = edges("edge1", "edges of the wide band", degenerate_with=("phi", "eps_slope"))(
    shifted_response(0)
)
narrow_edges = edges("edge2", "edges of the narrow band", degenerate_with=("phi", "eps_slope", "resp_long"))(
    shifted_response(1)
)


@responses(
    "resp_long",
    "long-wave tail of the responses",
    amplitude=Amplitude("change of the tail", "1", sigma=0.1, bounds=(-0.6, 0.8)),
    measurement="temperature of the detector recorded",
    degenerate_with=("edge2", "phi"),
)
def response_tail(scene, amplitude):
    """Both responses multiplied by a factor that grows from 1.05 um to 1 + a at 1.13 um: warmer silicon."""
    return scene.but(response_tail=scene.response_tail + amplitude)


@optics(
    "wshift",
    "wavelength scale of the spectrometer",
    klass="wavelength scale",
    amplitude=Amplitude("shift", "nm", sigma=0.3, bounds=(-3.0, 3.0)),
    phases=PHASES,
    measurement="a line lamp",
    steady_gas=True,
    instruments=SPECTROMETER,
)
def wavelength_shift(scene, amplitude):
    """The spectrometer reads each wavelength where another belongs, amplitude in nm: gas and surface move."""
    x = amplitude * NANOMETRE
    slope = np.gradient(scene.glow, scene.wavelength, axis=-1)
    return scene.but(wavelength_shift=scene.wavelength_shift + x, glow=scene.glow + x * slope)


@optics(
    "lsf",
    "slit function of the spectrometer",
    klass="slit function",
    amplitude=Amplitude("further standard deviation", "nm", sigma=0.2, bounds=(0.0, 1.0)),
    phases=BURNING,
    measurement="a line lamp",
    steady_gas=True,
    instruments=SPECTROMETER,
    quadratic=True,
)
def wider_slit(scene, amplitude):
    """A wider slit function: standard deviation `amplitude` [nm] added in quadrature."""
    change = np.sign(amplitude) * (amplitude * NANOMETRE) ** 2
    return scene.but(slit_sigma2=scene.slit_sigma2 + change)


@optics(
    "second",
    "second order of the grating",
    klass="stray light",
    amplitude=Amplitude("share", "1", sigma=0.5, bounds=(0.0, 10.0)),
    phases=BURNING,
    measurement="a long-pass filter of 550 nm",
    steady_gas=True,
    instruments=SPECTROMETER,
)
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


detector = partial(effect, stage="detector")


@detector(
    "phi",
    "error of the sensitivity ratio",
    klass="calibration ratio",
    amplitude=Amplitude("relative error", "1", sigma=0.015, bounds=(-0.2, 0.2)),
    phases=HOT,
    measurement=CALIBRATE_AGAIN,
    instruments=PYROMETER,
    reference=PAPER,
    degenerate_with=("edge2", "eps_slope"),
)
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


dark = partial(
    detector,
    amplitude=Amplitude("in units of the gas", "1", sigma=0.05, bounds=(-0.6, 0.6)),
    phases=PHASES,
)
offset_of = partial(
    dark,
    klass="offsets of the pyrometer",
    measurement="dark signal before and after",
    instruments=PYROMETER,
)
wide_offset = offset_of("off1", "offset of the wide band")(offset(0))
narrow_offset = offset_of("off2", "offset of the narrow band")(offset(1))


@dark(
    "off_s",
    "dark counts of the spectrometer",
    klass="dark counts",
    measurement="a dark spectrum after the test",
    instruments=SPECTROMETER,
)
def dark_counts(output, amplitude):
    """The same extra count rate in all pixels, in units of the mean of the gas."""
    level = np.mean(output.gas_level / output.factor)
    return output.value + amplitude * level * output.factor


@detector(
    "stray",
    "stray light in the spectrometer",
    klass="stray light",
    amplitude=Amplitude("share", "1", sigma=0.005, bounds=(0.0, 0.2)),
    phases=HOT,
    measurement="a long-pass filter",
    instruments=SPECTROMETER,
)
def stray(output, amplitude):
    """Stray light: every pixel gets a share of the mean count rate."""
    counts = output.value / output.factor
    mean = counts.mean(axis=1, keepdims=True)
    return (1 - amplitude) * output.value + amplitude * mean * output.factor


linearity = partial(detector, klass="linearity", phases=HOT)


@linearity(
    "nonlin_p",
    "nonlinear pyrometer",
    amplitude=Amplitude("at the largest signal", "1", sigma=0.02, bounds=(-0.3, 0.3)),
    measurement="two apertures or a neutral filter",
    instruments=PYROMETER,
)
def compressed_signal(output, amplitude):
    r"""Nonlinear detector: :math:`S (1 - a S/S_{max})`."""
    return output.value * (1 - amplitude * output.value / output.full_scale)


@linearity(
    "nonlin_s",
    "nonlinear spectrometer",
    amplitude=Amplitude("at the largest count", "1", sigma=0.02, bounds=(-0.3, 0.3)),
    measurement="one lamp at several exposure times",
    instruments=SPECTROMETER,
)
def compressed_counts(output, amplitude):
    r"""Nonlinear converter: :math:`U (1 - a U/U_{max})` in counts."""
    highest = np.max(output.full_scale / output.factor)
    return output.value * (1 - amplitude * (output.value / output.factor) / highest)


@effect(
    "clock",
    "clocks that disagree",
    stage="clock",
    klass="clock",
    amplitude=Amplitude("pyrometer early", "s", sigma=0.4, bounds=(-4.0, 4.0)),
    phases=("heating", "cooling"),
    measurement="one flash of light seen by both",
    instruments=PYROMETER,
    degenerate_with=("grad",),
)
def pyrometer_late(amplitude):
    """Shift of time [s]: the clock of the pyrometer is off."""
    return amplitude
