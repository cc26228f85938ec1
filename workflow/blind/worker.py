"""The analyser's process: diagnoses data folders, one line of JSON in, one out; it never sees a truth.

Run by `run.py`; prepares the calibration files of the laboratories and simulates gases at other pressures
too, as a user of the package would.
"""

import json
import os
import sys
import time
import traceback
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


def prepare(order):
    """Calibration files of one laboratory, from its lamp files."""
    from plasmapyro import io
    from plasmapyro.instrument.stage import pyrometer_calibration, spectrometer_calibration

    folder = Path(order["laboratory"])
    response = io.read(folder / "response.nc", "response")
    points = io.read(folder / "calibration_points.nc", "calibration_points")
    counts = io.read(folder / "spectrometer_counts.nc", "spectrometer_counts")
    calibration = pyrometer_calibration(
        response,
        points,
        source_temperature_uncertainty=3.0,
        signal_uncertainty=0.01,
        instrument_range=(973.0, 2073.0),
        calibration_temperature=np.arange(400.0, 4001.0, 10.0),
        draws=500,
        seed=1,
    )
    spectrometer = spectrometer_calibration(
        counts,
        source_temperature_uncertainty=3.0,
        saturation_counts=65000.0,
        least_net_counts=50.0,
        noise_block=20,
    )
    io.write(calibration, folder / "calibration.nc", "calibration")
    io.write(spectrometer, folder / "spectrometer_calibration.nc", "spectrometer_calibration")
    return {}


def simulate(order):
    """Spectra at another pressure, with variations, along the temperatures of the main job's sight lines."""
    from plasmapyro import conditions, io
    from plasmapyro.diagnosis.gas.other_pressure import simulated_at

    results, folder = Path(order["results"]), Path(order["folder"])
    lines, views, spectra = (
        {path.stem: io.read(path, kind) for path in sorted((results / kind).glob("[!.]*.nc"))}
        for kind in ("sightline", "surface_view", "radiation")
    )
    found, varied = simulated_at(
        order["pressure"],
        tuple(views),
        lines,
        views,
        spectra,
        wavelength=next(iter(spectra.values()))["wavelength"].values,
        response=io.read(results / "instrument/response.nc", "response"),
    )
    for name, made in found.items():
        # The gas of this laboratory has the temperatures of these flows.
        del made.attrs[conditions.FLOW_PRESSURE]
        io.write(made, folder / f"radiation/{name}.nc", "radiation")
    for name, made in varied.items():
        io.write(made, folder / f"radiation_variations/{name}.nc", "gas_variations")
    return {}


def diagnose(order, kept={}):  # noqa: B006  (spectra are read once, calibrations once per laboratory)
    """Diagnose the folder of one case."""
    from plasmapyro.diagnosis import command

    os.chdir(order["data"])
    radiance, laboratory = order["radiance"], order["laboratory"]
    if radiance not in kept:
        kept[radiance] = command.gas_of(Path(radiance))
    if (radiance, laboratory) not in kept:
        kept[radiance, laboratory] = command.with_instrument(kept[radiance], laboratory)
    start, processor = time.monotonic(), time.process_time()
    more = {}
    if order["without"]:
        more["without"] = tuple(order["without"])
    if order["sabotage"]:
        from blind.sabotage import sabotaged

        more["effects"] = sabotaged(order["sabotage"])
    result = command.diagnose_test(Path("test.nc"), kept[radiance, laboratory], **more)
    cost = {"wall": time.monotonic() - start, "processor": time.process_time() - processor}
    out = Path(order["out"])
    out.mkdir(parents=True, exist_ok=True)
    (out / "diagnosis.json").write_text(json.dumps(result.report), encoding="utf-8")
    result.temperature.to_netcdf(out / "temperature.nc")
    return cost


DO = prepare, simulate, diagnose


def main():
    """Serve orders until the input ends."""
    answers, sys.stdout = sys.stdout, sys.stderr
    for line in sys.stdin:
        order = json.loads(line)
        try:
            answer = {"ok": True} | {one.__name__: one for one in DO}[order["do"]](order)
        except Exception as fault:  # a fault of the analyser is a result of the test, not its end
            answer = {
                "ok": False,
                "fault": f"{type(fault).__name__}: {fault}",
                "trace": traceback.format_exc(),
            }
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
