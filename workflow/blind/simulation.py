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
    lines, views, spectra = (
        {path.stem: io.read(path, kind) for path in sorted((results / kind).glob("[!.]*.nc"))}
        for kind in ("sightline", "surface_view", "radiation")
    )
    wavelength = next(iter(spectra.values()))["wavelength"].values
    response = io.read(results / "instrument/response.nc", "response")
    given = lines, views, spectra
    found, varied = simulated_at(pressure, tuple(views), *given, wavelength=wavelength, response=response)
    for name, made in found.items():
        # The gas of this laboratory has the temperatures of these flows.
        del made.attrs[conditions.FLOW_PRESSURE]
        io.write(made, folder / f"radiation/{name}.nc", "radiation")
    for name, made in varied.items():
        io.write(made, folder / f"radiation_variations/{name}.nc", "gas_variations")
