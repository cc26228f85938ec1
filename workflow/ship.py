"""Makes the simulations that come with the package from the results of a run (`make simulations`)."""

import argparse
import re
from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro import conditions, io, seals
from plasmapyro.flow import guess
from plasmapyro.flow.condition import Condition
from plasmapyro.flow.dataset import setup_of
from plasmapyro.flow.meshes import meshes_of
from plasmapyro.flow.physics import REFERENCE_PRESSURE, REFERENCE_VELOCITY
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


def first_guesses(results, names):
    """Store states of the flow at the powers, from which those of a run begin (`plasmapyro.flow.guess`)."""
    start = io.read(results / "flow/start/reference.nc", "flow")
    meshes, setup = meshes_of(start, setup_of(start).torch), setup_of(start)
    vertices = [meshes(factor).restrict("flow").p for factor in start.solver_mesh_factor.values]
    flows = [io.read(results / f"flow/{name}.nc", "flow") for name in names]
    states = [np.array([_state(flow, vertices[0].shape[1]) for flow in flows])]
    for level in range(1, len(vertices)):
        states.append(np.array([one.solver_state.values[one.solver_state_mesh == level] for one in flows]))
    (said,) = {guess.told(setup, flow, Condition.of(flow)) for flow in flows}
    kept = guess.gathered(np.array([float(flow.numerical_power) for flow in flows]), states, said, vertices)
    place = PLACE.parents[1] / f"{guess.NAME}.npz"
    place.parent.mkdir(exist_ok=True)
    np.savez_compressed(place, **kept)
    valid = "a first guess, whatever it is worth"
    text = CERTIFICATE.format(versions=told(), valid=valid, digest=seals.digest(place))
    text = re.sub("title: .*", "title: First guess of the flow at nine powers", text)
    io.write_text(
        re.sub("uncertainty: .*", f"uncertainty: quanta of the fields {guess.QUANTA}", text),
        place.with_suffix(".yml"),
    )


def _state(flow, vertices):
    """State of the solver on the finest mesh."""
    speeds = [flow.axial_velocity / REFERENCE_VELOCITY, flow.radial_velocity / REFERENCE_VELOCITY]
    pressure = (flow.pressure - flow.chamber_pressure)[:vertices] / REFERENCE_PRESSURE
    return np.concatenate([*speeds, np.log(flow.temperature), pressure])


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("results", nargs="?", type=Path, default=Path("results"))
    results = options.parse_args().results
    dataset, paths = gathered(results)
    first_guesses(results, [path.stem for path in paths if path.parent.name == "radiation"])
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
    text = CERTIFICATE.format(versions=told(), valid=valid, digest=seals.digest(PLACE))
    io.write_text(text, PLACE.with_suffix(".yml"))


if __name__ == "__main__":
    main()
