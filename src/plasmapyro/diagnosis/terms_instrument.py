"""Terms of the instruments: optics, detectors, clocks."""

import numpy as np

NANOMETRE = 1e-9


def shifted_response(band):
    """A term: the response of a band moved along the wavelength, amplitude in nm."""

    def apply(scene, amplitude):
        shift = list(scene.response_shift)
        shift[band] += amplitude * NANOMETRE
        return scene.but(response_shift=tuple(shift))

    return apply


def response_tail(scene, amplitude):
    """Both responses multiplied by a factor that grows from 1.05 um to 1 + a at 1.13 um: warmer silicon."""
    return scene.but(response_tail=scene.response_tail + amplitude)


def wavelength_shift(scene, amplitude):
    """The spectrometer reads each wavelength where another belongs, amplitude in nm: gas and surface move."""
    if scene.kind != "spectrometer":
        return scene
    x = amplitude * NANOMETRE
    slope = np.gradient(scene.glow, scene.wavelength, axis=-1)
    return scene.but(wavelength_shift=scene.wavelength_shift + x, glow=scene.glow + x * slope)


def wider_slit(scene, amplitude):
    """A wider slit function: standard deviation `amplitude` [nm] added in quadrature."""
    if scene.kind != "spectrometer":
        return scene
    change = np.sign(amplitude) * (amplitude * NANOMETRE) ** 2
    return scene.but(slit_sigma2=scene.slit_sigma2 + change)


def _of(kind):
    """Decorator: a term of one instrument leaves the other alone."""

    def wrap(function):
        def apply(output, amplitude, **shape):
            if output.kind != kind:
                return output
            return output.but(function(output, amplitude, **shape))

        apply.__doc__ = function.__doc__
        return apply

    return wrap


def offset(band):
    """A term: a constant on a band, in units of the signal of the gas."""

    @_of("pyrometer")
    def apply(output, amplitude):
        extra = np.zeros(2)
        extra[band] = output.gas_level[band]
        return output.value + amplitude * extra

    return apply


@_of("spectrometer")
def dark_counts(output, amplitude):
    """The same extra count rate in all pixels, in units of the mean of the gas."""
    level = np.mean(output.gas_level / output.factor)
    return output.value + amplitude * level * output.factor


@_of("pyrometer")
def compressed_signal(output, amplitude):
    r"""Nonlinear detector: :math:`S (1 - a S/S_{max})`."""
    return output.value * (1 - amplitude * output.value / output.full_scale)


@_of("spectrometer")
def compressed_counts(output, amplitude):
    r"""Nonlinear converter: :math:`U (1 - a U/U_{max})` in counts."""
    highest = np.max(output.full_scale / output.factor)
    return output.value * (1 - amplitude * (output.value / output.factor) / highest)


@_of("pyrometer")
def ratio(output, amplitude):
    r"""Error of the ratio of sensitivities: :math:`\varphi e^d`."""
    return output.value * np.exp(amplitude * np.array([1.0, 0.0]))


@_of("spectrometer")
def stray(output, amplitude):
    r"""Stray light: every pixel gets a share of the mean count rate."""
    counts = output.value / output.factor
    mean = counts.mean(axis=1, keepdims=True)
    return (1 - amplitude) * output.value + amplitude * mean * output.factor


def pyrometer_late(kind, amplitude, shape):
    """Shift of time [s] of an instrument: the clock of the pyrometer is off."""
    return amplitude if kind == "pyrometer" else 0.0
