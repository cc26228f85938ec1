"""A simulation of the gas at another pressure, made by the package as a user of it would: run by `worker.py`.

Along the temperatures of the main job's sight lines: radiation of the powers that a test may have, variations
of those that the main job varies.
"""

from pathlib import Path


def simulate(results, folder, pressure):
    """Write `radiation` and `radiation_variations` of a pressure [Pa] into a folder."""
    from plasmapyro import conditions, io
    from plasmapyro.diagnosis.gas.other_pressure import simulated_at

    results, folder = Path(results), Path(folder)
    kinds = {"radiation": "radiation", "sightline": "sightline", "surface_view": "surface_view"}
    read = {
        kind: {path.stem: io.read(path, kind) for path in sorted((results / place).glob("[!.]*.nc"))}
        for kind, place in kinds.items()
    }
    response = io.read(results / "instrument/response.nc", "response")
    for name in sorted(read["surface_view"]):
        wavelength = read["radiation"][name]["wavelength"].values
        given = read["sightline"], read["surface_view"], read["radiation"]
        found, varied = simulated_at(pressure, name, *given, wavelength=wavelength, response=response)
        io.write(varied, folder / f"radiation_variations/{name}.nc", "gas_variations")
        for other, made in found.items():
            del made.attrs[
                conditions.FLOW_PRESSURE
            ]  # the gas of this laboratory has the temperatures of these flows
            io.write(made, folder / f"radiation/{other}.nc", "radiation")
