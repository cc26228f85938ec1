"""Effects between the gas and the instruments: windows and air."""

from functools import cache, partial

import numpy as np

from plasmapyro import tables
from plasmapyro.diagnosis.effects.effect import (
    EXPOSED,
    HOT,
    PHASES,
    PYROMETER,
    SPECTROMETER,
    Amplitude,
    effect,
)
from plasmapyro.diagnosis.effects.surface import PIVOT

path = partial(effect, stage="path")
window = partial(path, phases=HOT, measurement="a lamp seen through the window before and after the test")


def grey_deposit(scene, amplitude):
    r"""A grey deposit: :math:`\tau = \tau_0 (1 - a\,t/t_{off})`."""
    return scene.but(path=scene.path * (1 - amplitude * scene.exposure[..., None]))


def blue_deposit(scene, amplitude, *, exponent):
    r"""A deposit of fine grains: :math:`1 - a (t/t_{off}) (\lambda/0.95\,\mu m)^{-n}`."""
    loss = amplitude * scene.exposure[..., None] * (scene.wavelength / PIVOT) ** -exponent
    return scene.but(path=scene.path * (1 - loss))


grey = partial(window, amplitude=Amplitude("loss at the end", "1", sigma=0.07, bounds=(-0.2, 0.8)))
window_d = grey(
    "winD",
    "deposit on window D",
    klass="throughput of the pyrometer",
    instruments=PYROMETER,
    degenerate_with=("winD_sl",),
)(grey_deposit)
window_e = grey(
    "winE",
    "deposit on window E",
    klass="throughput of the spectrometer",
    instruments=SPECTROMETER,
    degenerate_with=("winE_sl", "eps_ox"),
)(grey_deposit)
blue = partial(
    window,
    amplitude=Amplitude("loss at 950 nm", "1", sigma=0.05, bounds=(-0.1, 0.6)),
    shape={"exponent": ((1.0, 2.5, 4.0), (0.7, 4.2))},
)
window_d_blue = blue(
    "winD_sl",
    "blue deposit on window D",
    klass="throughput of the pyrometer",
    instruments=PYROMETER,
    degenerate_with=("winD",),
)(blue_deposit)
window_e_blue = blue(
    "winE_sl",
    "blue deposit on window E",
    klass="throughput of the spectrometer",
    instruments=SPECTROMETER,
    degenerate_with=("winE",),
)(blue_deposit)


def absorber(name):
    r"""Formula of more absorption in air than during the calibration, :math:`e^{-a k(\lambda)}`."""
    load = cache(tables.load)  # at every evaluation it would be a tenth of a diagnosis

    def absorb(scene, amplitude):
        table = load(f"diagnosis/{name}")
        shape = np.interp(scene.wavelength, table["wavelength"], table["absorption"], left=0.0, right=0.0)
        return scene.but(path=scene.path * np.exp(-amplitude * shape))

    return absorb


air = partial(
    path,
    klass="air",
    amplitude=Amplitude("absorption in the strongest bin", "1", sigma=0.02, bounds=(-0.2, 0.3)),
    phases=PHASES,
)
water = air("h2o", "water vapour in the optical path", measurement="purge the path with dry gas")(
    absorber("water_vapour")
)
oxygen = air(
    "o2a",
    "oxygen in the optical path",
    measurement="length of the path against that of the calibration",
)(absorber("oxygen_a_band"))


@path(
    "scat",
    "scattering by grains",
    klass="grains",
    amplitude=Amplitude("loss at 950 nm", "1", sigma=0.01, bounds=(0.0, 0.3)),
    phases=EXPOSED,
    measurement="a lamp through the seeded jet",
    degenerate_with=("particles",),
)
def scattering(scene, amplitude):
    r"""Grains in the jet that scatter light out of the beam: :math:`1 - w (\lambda/0.95\,\mu m)^{-2}`."""
    loss = amplitude * (scene.injected * scene.plasma)[..., None] * (scene.wavelength / PIVOT) ** -2.0
    return scene.but(path=scene.path * (1 - loss))
