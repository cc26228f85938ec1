"""The calibration of a test: stored, or still raw, in the test's folder or beside it."""

import os
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from plasmapyro import cli, io, progress
from plasmapyro.commands import calibrate
from plasmapyro.readers.calibration import describes

NAME = "calibration"  # of the folder that is looked for, and of the pyrometer's file in it


@contextmanager
def calibration_of(test, given=None):
    """A folder with calibration.nc, response.nc and spectrometer_calibration.nc, as far as there are such.

    Without one `given` it is the folder `calibration` in or beside the test. Of raw files with
    calibration.yaml, calibrated with the usual settings, it lasts as long as the context. ValueError: no such
    folder; raw files that cannot be used.
    """
    folder = Path(given) if given else _beside(Path(test))
    if not folder.is_dir():
        raise ValueError(f"{folder}: no such folder; name the one that holds {NAME}.nc")
    if not describes(folder) or (folder / f"{NAME}.nc").exists():
        yield folder
        return
    options = cli.parser(["calibrate"]).parse_args(["calibrate", str(folder), "--out", "."])
    with TemporaryDirectory() as place:
        found = [(Path(place) / f"{name}.nc", one) for name, one in calibrate.calibrated(options).items()]
        io.write_labelled(found)
        yield Path(place)


def _beside(test):
    places = [test / NAME, Path(os.path.normpath(test / ".." / NAME))]  # also of "."
    for place in places:
        if place.is_dir():
            progress.say(f"calibration: {place}")
            return place
    raise ValueError(
        f"no calibration: neither {places[0]} nor {places[1]} is there; name its folder with --instrument"
    )
