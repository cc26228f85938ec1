"""Makes the simulations that come with the package from the results of a run (`make simulations`)."""

import argparse
import hashlib
from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro import conditions, io
from plasmapyro.versions import told

PLACE = Path(__file__).resolve().parents[1] / "src/plasmapyro/data/simulations/air_50mbar_16gs.nc"
BITS = 16  # of the mantissa: 8e-6, a hundredth of what the engine itself is sure of
ERROR_BITS = 7  # the same of the modes of its error
CERTIFICATE = """\
title: Light of the gas between torch and probe at nine powers, and of gas varied from them
source: results of the main job of this package (workflow/ship.py)
origin: modelled
obtained: "computed with {versions}"
licence: own work, BSD-3-Clause
valid: "{valid}"
uncertainty: modes of the error of the spectra, in error_share (rounded to 0.4 %); the rest is rounded to 8e-6
sha256: {digest}
"""


def gathered(results):
    """Dataset of contract 'simulations' and the paths it was read from."""
    signals = results / "analysis/gas_signal.nc"
    light = io.read(signals, "gas_signal")
    names, paths, parts, depth = [str(name) for name in light.condition.values], [signals], [], []
    for name in names:
        files = [results / f"{folder}/{name}.nc" for folder in ("radiation", "radiation_variations")]
        radiation, varied = io.read(files[0], "radiation"), io.read(files[1], "gas_variations")
        seen = [one for one in radiation.data_vars if one.endswith("_slit")]
        parts.append(xr.merge([radiation[[*seen, "component_uncertainty"]], varied], combine_attrs="drop"))
        depth.append(varied.attrs["optical_depth_simulated"])
        paths += files
    own = [name for name in parts[0].data_vars if name != "component_uncertainty"]
    whole = xr.concat(parts, "condition", data_vars=own, coords="minimal", compat="equals", join="exact")
    # Relative errors are much the same at all powers: those of the middle one stand for all.
    modes = io.read(results / f"radiation/{names[len(names) // 2]}.nc", "radiation")
    whole = whole.merge(modes[["error_share", "error_system", "error_cause"]], combine_attrs="drop")
    light = light.drop_vars("chamber_pressure").assign(optical_depth_simulated=("condition", depth))
    whole = xr.merge([whole.assign_coords(condition=names), light], combine_attrs="drop", join="exact")
    common = conditions.carried(radiation) | {key: radiation.attrs[key] for key in ("slit_fwhm", "origin")}
    del common[conditions.POWER]
    return whole.assign_attrs(title="Simulations that come with plasmapyro", **common), paths


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("results", nargs="?", type=Path, default=Path("results"))
    dataset, paths = gathered(options.parse_args().results)
    io.write_packed(
        dataset, PLACE, "simulations", bits=BITS, bits_of={"error_share": ERROR_BITS}, sources=paths
    )
    power, seen = dataset.numerical_power.values / 1e3, dataset.wavelength_slit.values * 1e9
    valid = (
        f"{dataset.attrs['gas']}, {dataset.attrs['chamber_pressure'] / 100:g} mbar,"
        f" {dataset.attrs['mass_flow_rate'] * 1e3:g} g/s, {power.min():g} to {power.max():g} kW in the gas,"
        f" {seen[0]:.0f} to {seen[-1]:.0f} nm,"
        f" slit {np.round(dataset.attrs['slit_fwhm'] * 1e9, 3)} nm"
    )
    text = CERTIFICATE.format(
        versions=told(), valid=valid, digest=hashlib.sha256(PLACE.read_bytes()).hexdigest()
    )
    io.write_text(text, PLACE.with_suffix(".yml"))


if __name__ == "__main__":
    main()
