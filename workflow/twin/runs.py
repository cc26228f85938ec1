"""A campaign of tests with a hidden law: efficiency, windows that foul, a wrong ratio, two materials.

What the laboratory knows stands in its plan (`config/campaign.yaml`); what is true stands here.
"""

from dataclasses import replace
from datetime import date

import numpy as np
import xarray as xr

from twin import light
from twin.campaign import Scene
from twin.sample import Sample

# simulated over electric power, at 160 kW; law in the power
EFFICIENCY, EXPONENT, REFERENCE = 0.53, -0.25, 160e3
SCATTER = 0.02  # of its logarithm
LOSS = {"pyrometer": 0.004, "spectrometer": 0.008}  # of throughput in a run
LOSS_SCATTER = 0.0015
CLEAN = 0.01  # scatter of the throughput of a clean window over that of the calibration
RATIO = 0.004  # of the pyrometer since its calibration: standard deviation of what is drawn
SCALE = 0.008  # of the spectrometer, half slope, half wave: standard deviation at the ends of the spectrum
STATED = {"C/SiC": (0.85, 0.05), "SiC": (0.90, 0.05), "cavity": (0.99, 0.01)}  # emittances, how well known
BLACK = 0.999  # most of an emittance
PIECE = 0.008  # scatter of samples
ODD, OFF = 4, -0.15  # the fifth test: its torch ran at another mass flow than the laboratory believes
NOMINAL = 0.5  # efficiency by which the laboratory chooses a simulation
FLUX = 4.5e5  # [W m-2] at the reference power


def instrument(seed):
    """What is true of all tests: `ratio`, `scale` (slope, wave, phase), `emittance` {material: value}."""
    random = np.random.default_rng([seed, 72])
    slope, wave, ratio, *materials = random.normal(size=3 + len(STATED))
    return {
        "ratio": RATIO * ratio,
        "scale": (SCALE * slope / np.sqrt(2), SCALE * wave / np.sqrt(2), random.uniform(0, 2 * np.pi)),
        "emittance": {
            name: min(value + known * one, BLACK)
            for (name, (value, known)), one in zip(STATED.items(), materials, strict=True)
        },
    }


def truth(plan, seed):
    """What is true of each test of a plan: list of dicts with `power` [W], `emittance`, `clean`, `loss`, and
    of the instrument."""
    shared = instrument(seed)
    random = np.random.default_rng([seed, 71])
    cleanings = [date.fromisoformat(one) for one in plan.get("cleanings", [])]
    found, epoch = [], None
    for place, test in enumerate(plan["tests"]):
        before = sum(one <= date.fromisoformat(test["date"]) for one in cleanings)
        drawn = random.normal(size=6)
        if before != epoch:
            start = dict(zip(LOSS, CLEAN * drawn[:2], strict=True))
        loss = {name: LOSS[name] + LOSS_SCATTER * one for name, one in zip(LOSS, drawn[2:4], strict=True)}
        electric = 1e3 * test["electric_power_kw"]
        law = np.log(EFFICIENCY) + EXPONENT * np.log(electric / REFERENCE) + SCATTER * drawn[4]
        found.append(
            {
                "power": electric * np.exp(law + OFF * (place == ODD)),
                "emittance": min(shared["emittance"][test["material"]] * np.exp(PIECE * drawn[5]), BLACK),
                "instrument": shared,
                "clean": start,
                "loss": loss,
            }
        )
        start, epoch = {name: start[name] - loss[name] for name in LOSS}, before
    return found


def scene(test, true):
    """The scene of a test of a plan with what is true of it."""
    electric, off = 1e3 * test["electric_power_kw"], 120.0
    stated, known = STATED[test["material"]]
    plain = Scene(
        condition=f"{round(NOMINAL * electric / 1e4) * 10}kW",
        end=170.0,
        plasma_off_time=off,
        electric_power=electric,
        stated_emittance=stated,
        stated_emittance_uncertainty=known,
        sample=Sample(emittance=true["emittance"], cold_wall_heat_flux=FLUX * electric / REFERENCE),
        centred_exposures=True,
    )

    def window(instrument, wavelength, time):
        exposed = np.clip(time / off, 0.0, 1.0)
        return np.exp(true["clean"][instrument] - true["loss"][instrument] * exposed)

    def readings(clean, time):
        return clean * np.exp([[true["instrument"]["ratio"]], [0.0]])

    def rates(clean, time):
        slope, wave, phase = true["instrument"]["scale"]
        place = (plain.spectrometer.wavelength - 0.9e-6) / 0.12e-6  # 1 at the ends of what is compared
        return clean * np.exp(slope * place + wave * np.sqrt(2) * np.sin(2 * np.pi * place / 3 + phase))

    return replace(plain, transmittance=window, pyrometer_output=readings, spectrometer_output=rates)


def without_spectra(test):
    """A test as it is when the spectrometer is away."""
    return test.drop_dims(["spectrum_time", "wavelength"])


def gas(radiation, power):
    """Spectrum at a power [W] between those of the files {power [W]: Dataset}, linear in the logarithms."""
    powers = np.array(sorted(radiation))
    above = int(np.clip(np.searchsorted(powers, power), 1, powers.size - 1))
    low, high = powers[above - 1 : above + 1]
    share = np.log(power / low) / np.log(high / low)
    found = light.between(share, *(radiation[one].gas_radiance.values for one in (low, high)))
    return xr.Dataset(
        {"gas_radiance": ("wavelength", found)}, {"wavelength": radiation[low].wavelength.values}
    )
