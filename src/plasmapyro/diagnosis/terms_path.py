"""Terms between the gas and the instruments: windows and air."""

from functools import cache

import numpy as np

from plasmapyro import tables
from plasmapyro.diagnosis.terms_surface import PIVOT


def _window(kind):
    def grey(scene, amplitude):
        r"""A grey deposit: :math:`\tau = \tau_0 (1 - a\,t/t_{off})`."""
        if scene.kind != kind:
            return scene
        return scene.but(path=scene.path * (1 - amplitude * scene.exposure[..., None]))

    def sloped(scene, amplitude, *, exponent):
        r"""A deposit of fine grains: :math:`1 - a (t/t_{off}) (\lambda/0.95\,\mu m)^{-n}`."""
        if scene.kind != kind:
            return scene
        loss = amplitude * scene.exposure[..., None] * (scene.wavelength / PIVOT) ** -exponent
        return scene.but(path=scene.path * (1 - loss))

    return grey, sloped


window_d, window_d_sloped = _window("pyrometer")
window_e, window_e_sloped = _window("spectrometer")


def absorber(name):
    """A term: more absorption in air than during the calibration, :math:`e^{-a k(\\lambda)}`."""

    load = cache(tables.load)  # at every evaluation it would be a tenth of a diagnosis

    def apply(scene, amplitude):
        table = load(f"diagnosis/{name}")
        shape = np.interp(scene.wavelength, table["wavelength"], table["absorption"], left=0.0, right=0.0)
        return scene.but(path=scene.path * np.exp(-amplitude * shape))

    return apply


def scattering(scene, amplitude):
    r"""Grains in the jet that scatter light out of the beam: :math:`1 - w (\lambda/0.95\,\mu m)^{-2}`."""
    loss = amplitude * (scene.injected * scene.plasma)[..., None] * (scene.wavelength / PIVOT) ** -2.0
    return scene.but(path=scene.path * (1 - loss))
