"""An invented gas with all systems and a small scene: hidden effects without files of the main job."""

import numpy as np
import xarray as xr
from half_disc import flow
from twin import campaign, gas, incident
from twin.sensors import Spectrometer

SYSTEMS = ("N I", "O I", "N2 1P", "N2+ Meinel", "NO 11000 A", "e-neutral free-free", "O- detachment")
TEMPERATURE = np.array([350.0, 3000.0, 6000.0, 6000.0, 3000.0, 350.0])
DISTANCE = np.array([0.0, 0.004, 0.01, 0.1, 0.13, 0.15])
FINE = np.linspace(DISTANCE[0], DISTANCE[-1], 151)
NITROGEN = (745.5, 821.5, 862.0, 869.3, 939.7, 1011.8)  # [nm]
OXYGEN = (777.408, 777.631, 777.753, 844.87, 926.6)
SPECIES = ("N2", "N", "O", "N2+", "NO", "e-")


def spectra():
    """Spectra at 50, 80 and 130 kW: lines of atoms, smooth molecules and continua; brighter with power."""
    centres = np.arange(gas.FIRST + gas.BIN / 2, gas.LAST, gas.BIN)
    radiance = np.zeros((3, len(SYSTEMS), centres.size))
    for row, places in enumerate((NITROGEN, OXYGEN)):
        radiance[:, row] = gas.narrow(centres, places, [0.2] * len(places))
    smooth = np.exp(-(((centres - 1.0e-6) / 0.15e-6) ** 2))
    for row, peak in ((2, 2e7), (3, 6e6), (4, 2e6), (5, 1e6), (6, 5e5)):
        radiance[:, row] = peak * smooth
    growth = (np.array([50, 80, 130])[:, None] / 80) ** np.array([5, 6, 0.5, 1, 0.5, 1, 1])
    return gas.Spectra(np.array([50e3, 80e3, 130e3]), centres, SYSTEMS, radiance * growth[:, :, None])


def density(temperature):
    """Densities [m-3] that fall and rise with temperature as those of a plasma do."""
    number = 5000.0 / (1.380649e-23 * temperature)
    atoms = 1 / (1 + np.exp(-(temperature - 6000) / 500))
    charged = 1e-3 * np.exp(-(120000 / temperature - 20))
    shares = {"N2": 0.8 * (1 - atoms), "N": 0.8 * atoms, "O": 0.3 * atoms, "NO": 0.02 * (1 - atoms)}
    shares |= {"N2+": charged, "e-": 2 * charged}
    return {name: number * share for name, share in shares.items()}


def plasma():
    """The gas at 80 kW."""
    kept, table = spectra(), np.linspace(300.0, 14000.0, 275)
    return gas.Gas(
        kept.centres,
        SYSTEMS,
        kept.radiance[1],
        DISTANCE,
        TEMPERATURE,
        table,
        density(table),
        weakest=kept.radiance[0].sum(axis=0),
        view=incident.view(flow(lambda away: np.interp(away, DISTANCE, TEMPERATURE), FINE), table),
    )


def scene(**changes):
    """A short scene: a reading each second, a spectrum every four, 360 pixels."""
    settings = {
        "condition": "80kW",
        "end": 330.0,
        "pyrometer_period": 1.0,
        "spectrometer_period": 4.0,
        "spectrometer": Spectrometer(pixels=360),
    }
    return campaign.Scene(**settings | changes)


def as_dataset(spectrum, centres):
    """A spectrum as the twin reads it from a file."""
    return xr.Dataset({"gas_radiance": ("wavelength", spectrum)}, {"wavelength": centres})
