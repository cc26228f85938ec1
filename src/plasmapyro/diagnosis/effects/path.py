"""Effects between the gas and the instruments: windows and air."""

from functools import cache

import numpy as np

from plasmapyro import tables
from plasmapyro.diagnosis.effects.effect import effect
from plasmapyro.diagnosis.effects.surface import PIVOT


def grey_deposit(scene, amplitude):
    r"""A grey deposit: :math:`\tau = \tau_0 (1 - a\,t/t_{off})`."""
    return scene.but(path=scene.path * (1 - amplitude * scene.exposure[..., None]))


def blue_deposit(scene, amplitude, *, exponent):
    r"""A deposit of fine grains: :math:`1 - a (t/t_{off}) (\lambda/0.95\,\mu m)^{-n}`."""
    loss = amplitude * scene.exposure[..., None] * (scene.wavelength / PIVOT) ** -exponent
    return scene.but(path=scene.path * (1 - loss))


GRAINS = {"exponent": ((1.0, 2.5, 4.0), (0.7, 4.2))}
window_d, window_e = effect("winD")(grey_deposit), effect("winE")(grey_deposit)
window_d_blue = effect("winD_sl", shape=GRAINS)(blue_deposit)
window_e_blue = effect("winE_sl", shape=GRAINS)(blue_deposit)


def absorber(name):
    r"""Formula of more absorption in air than during the calibration, :math:`e^{-a k(\lambda)}`."""
    load = cache(tables.load)  # at every evaluation it would be a tenth of a diagnosis

    def absorb(scene, amplitude):
        table = load(f"diagnosis/{name}")
        shape = np.interp(scene.wavelength, table["wavelength"], table["absorption"], left=0.0, right=0.0)
        return scene.but(path=scene.path * np.exp(-amplitude * shape))

    return absorb


water = effect("h2o")(absorber("water_vapour"))
oxygen = effect("o2a")(absorber("oxygen_a_band"))


@effect("scat", shape={"exponent": ((1.0, 2.5, 4.0), (0.0, 4.2))})
def scattering(scene, amplitude, *, exponent):
    r"""Grains in the jet that scatter light out of the beam: :math:`1 - w (\lambda/0.95\,\mu m)^{-n}`.

    From n = 0 of grains larger than the wavelength to 4 of much smaller ones: C. F. Bohren & D. R. Huffman,
    Absorption and Scattering of Light by Small Particles (1983), chapters 4 and 5.
    """
    loss = amplitude * (scene.injected * scene.plasma)[..., None] * (scene.wavelength / PIVOT) ** -exponent
    return scene.but(path=scene.path * (1 - loss))
