"""What the paper takes for granted on its way (secs. 1, 2, 4.1, 4.2): what it neglects, and why it may."""

import json
from math import nan, pi

import numpy as np

from plasmapyro.claims.claim import Claim
from plasmapyro.conditions import number
from plasmapyro.radiation.planck import blackbody_radiance

ATOMS = ("N I", "O I", "N II", "O II")
SEEN = 0.05  # [1] of the peak: where a band counts as open
AT = 1350.0  # [K], where the paper's measured reading is 1 % off
CORE = 0.5  # [1] of the highest temperature: gas of the jet


def reflection_claims(reflection):
    """Claims on the reflected light of the gas. `reflection`: contract 'reflection', or None."""
    return [
        Claim(
            f"reflection_{surface}",
            "2, 5.1",
            f"Reflected light of the gas is negligible for an emittance of 0.8 or more ({surface} sample).",
            _reflected(reflection, surface) if reflection is not None else nan,
            "%",
            0,
            1,
            f"By how much it shifts the reading at {AT:.0f} K and emittance 0.8, median of the powers;"
            " 'negligible' read as below 1 %. " + words,
        )
        for surface, words in (
            ("mirror", "A mirror shows the line of sight once more."),
            (
                "matt",
                "A matt sample scatters light of the torch's bright core, which the line of sight misses.",
            ),
        )
    ]


def _reflected(reflection, surface):
    error = reflection.relative_error.sel(correction="none").sel(emittance=0.8, method="nearest")
    error = error.sel(object_temperature=AT, method="nearest")
    added = error.sel(surface=surface) - error.sel(surface="no reflection")
    return 100 * float(added.median())


def gas_claims(sightlines, radiances, variations, response, gas):
    """Claims on what the gas is and what of it may be left out.

    Parameters
    ----------
    sightlines, radiances : lists of Dataset, contracts 'sightline' and 'radiation', one per condition
    variations : Dataset, contract 'gas_variations', of one of the conditions, or None
    response : Dataset, contract 'response'
    gas : Dataset, contract 'gas'

    Returns
    -------
    list of Claim
    """
    shares = [_molecular_share(spectrum, response) for spectrum in radiances]
    return [
        Claim(
            "wall_temperature",
            "4.1",
            "The temperature of the probe, 350 K in the simulation, hardly matters for the gas radiance.",
            _warm_wall(variations, response),
            "%",
            0,
            5,
            "What a wall at 1600 K adds to the gas in the wide band, the boundary layer keeping its shape;"
            " 'limited effect' read as below 5 %.",
        ),
        Claim(
            "gas_beyond_the_domain",
            "4.1",
            "Beyond the simulated domain the gas may be taken as uniform: it adds nothing.",
            100 * max(map(_beyond, sightlines, radiances)),
            "%",
            0,
            1,
            "Even as black as a body can be, at the long end of the spectrum; largest of the powers.",
        ),
        Claim(
            "reynolds_number",
            "4.1",
            "The flow is laminar, with a Reynolds number of about 100.",
            float(np.median([_reynolds_number(line, gas) for line in sightlines])),
            "1",
            30,
            300,
            "Mass flow over the tube's circumference and the viscosity of the hottest gas on the line of"
            " sight, median of the powers; 'about' read as within a factor of 3; the paper does not say of"
            " which length and state.",
        ),
        Claim(
            "grid_independence",
            "4.1",
            "The grid does not matter.",
            100 * float(np.median([_mesh_error(line) for line in sightlines])),
            "%",
            0,
            1,
            "Largest estimated error of the temperature in the jet from three meshes, median of the powers;"
            " read as below 1 %. In the first millimetre at the wall it is larger.",
        ),
        Claim(
            "nitrogen_background",
            "4.2",
            "The light between the atomic lines is mainly that of the first positive system of N2.",
            100 * float(np.median(shares)),
            "%",
            50,
            100,
            "Its share of all that is not atomic lines, in the wide band, median of the powers (all:"
            f" {100 * min(shares):.0f} to {100 * max(shares):.0f} %).",
        ),
    ]


def design_claims(designs):
    """The claim on the best wavelengths. `designs`: contract 'band_design', or None."""
    return [
        Claim(
            "best_wavelength",
            "1",
            "Between 500 and 2500 K the sensitivity is highest around 1 µm.",
            _best_wavelength(designs) if designs is not None else nan,
            "nm",
            900,
            1100,
            "Middle of the two bands that measure best without a gas, over design.no_gas_temperature_k and"
            " the first detector of design.detectors; 'around' read as within 10 %. The detector decides:"
            " its noise, not the ratio alone.",
        )
    ]


def _best_wavelength(designs):
    bands = np.isfinite(designs.band_centre).sum("design_band")
    found = np.flatnonzero((designs.design_kind == "no gas") & (bands == 2))
    return 1e9 * float(designs.band_centre[found[0]].mean()) if found.size else nan


def _open(response, wavelength):
    """Response of the wide band at some wavelengths, zero outside it."""
    return np.interp(
        wavelength, response.wavelength.values, response.responsivity_wide.values, left=0.0, right=0.0
    )


def _warm_wall(variations, response):
    if variations is None:
        return nan
    weight = _open(response, variations.wavelength_slit.values)
    added = variations.added_radiance.sel(addition="warm_wall").values
    base = variations.core_radiance.sel(core_change=0.0, method="nearest").values
    return 100 * float(added @ weight / (base @ weight))


def _beyond(line, spectrum):
    """Light of black gas beyond the domain over that of the gas in it, at the last wavelength."""
    outside = line.path_distance > line.attrs["exit_distance"]
    black = blackbody_radiance(
        spectrum.wavelength_slit.values[-1:], float(line.temperature.where(outside).max())
    )
    return float(black[0] / spectrum.gas_radiance_slit.values[-1])


def _reynolds_number(line, gas):
    r""":math:`Re = 2 \dot m / (\pi R \mu)` of a tube of radius R; NaN of a flow that does not say."""
    settings = json.loads(line.attrs.get("flow_settings", "{}"))
    if "torch" not in settings:
        return nan
    pressure = np.clip(number(line, "chamber_pressure"), *gas.pressure.values[[0, -1]])
    state = {"pressure": pressure, "temperature": float(line.temperature.max())}
    viscosity = float(gas.viscosity.interp(state))
    return 2 * number(line, "mass_flow_rate") / (pi * json.loads(settings["torch"])["radius"] * viscosity)


def _mesh_error(line):
    if "temperature_error" not in line:
        return nan
    return float(
        (line.temperature_error / line.temperature)
        .where(line.temperature > CORE * line.temperature.max())
        .max()
    )


def _molecular_share(spectrum, response):
    weight = _open(response, spectrum.wavelength_slit.values)
    light = dict(
        zip(
            spectrum.component.values.astype(str),
            spectrum.gas_radiance_component_slit.values @ (weight > SEEN),
            strict=True,
        )
    )
    return light["N2 1P"] / sum(value for name, value in light.items() if name not in ATOMS)
