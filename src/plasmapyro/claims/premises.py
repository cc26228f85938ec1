"""What the paper takes for granted on its way (secs. 1, 2, 4.1, 4.2): what it neglects, and why it may."""

import json
from math import nan, pi

import numpy as np

from plasmapyro.claims.claim import claim
from plasmapyro.conditions import number
from plasmapyro.radiation.bandsignal import respond
from plasmapyro.radiation.planck import blackbody_radiance

ATOMS = ("N I", "O I", "N II", "O II")
SEEN = 0.05  # [1] of the peak: where a band counts as open
AT = 1350.0  # [K], where the paper's measured reading is 1 % off
CORE = 0.5  # [1] of the highest temperature: gas of the jet


def reflection_claims(reflection):
    """Claims on the reflected light of the gas. `reflection`: contract 'reflection', or None."""
    surfaces = ("mirror", "matt")
    values = [_reflected(reflection, one) if reflection is not None else nan for one in surfaces]
    return [claim(f"reflection_{one}", value, at=AT) for one, value in zip(surfaces, values, strict=True)]


def _reflected(reflection, surface):
    error = reflection.relative_error.sel(correction="none").sel(emittance=0.8, method="nearest")
    error = error.sel(object_temperature=AT, method="nearest")
    added = error.sel(surface=surface) - error.sel(surface="no reflection")
    return 100 * float(added.median())


def gas_claims(sightlines, radiances, variations, response, gas):
    """Claims on what the gas is and what of it may be left out; `variations` of one condition, or None."""
    shares = [100 * _molecular_share(spectrum, response) for spectrum in radiances]
    return [
        claim("wall_temperature", _warm_wall(variations, response)),
        claim("gas_beyond_the_domain", 100 * max(map(_beyond, sightlines, radiances))),
        claim("reynolds_number", np.median([_reynolds_number(line, gas) for line in sightlines])),
        claim("grid_independence", 100 * np.median([_mesh_error(line) for line in sightlines])),
        claim("nitrogen_background", np.median(shares), least=min(shares), most=max(shares)),
    ]


def design_claims(designs):
    """The claim on the best wavelengths. `designs`: contract 'band_design', or None."""
    return [claim("best_wavelength", _best_wavelength(designs) if designs is not None else nan)]


def _best_wavelength(designs):
    bands = np.isfinite(designs.band_centre).sum("design_band")
    found = np.flatnonzero((designs.design_kind == "no gas") & (bands == 2))
    return 1e9 * float(designs.band_centre[found[0]].mean()) if found.size else nan


def _open(response, wavelength):
    """Response of the wide band at some wavelengths, zero outside it."""
    return respond(wavelength, response.wavelength.values, response.responsivity_wide.values)


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
