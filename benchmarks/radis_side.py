"""RADIS on the line list and slabs of a file, timed; runs in its own environment (requirements.txt).

The lines enter as a line table (`df0`) as RADIS's loaders leave it; the partition functions come from the
file. Everything from the line table to the spectrum is RADIS's own, with its default settings.
"""

import sys
import warnings
from time import process_time

import numpy as np
import pandas as pd

warnings.simplefilter("ignore")

from radis import SerialSlabs, SpectrumFactory, __version__
from radis.tools.track_ref import RefTracker


class Factory(SpectrumFactory):
    """Spectrum factory with the partition functions of the benchmark; notes when the lines are summed."""

    lines_summed = 0.0

    def _calc_broadening(self):
        result = super()._calc_broadening()
        self.lines_summed = process_time()
        return result

    def Qref_Qgas_ratio(self, df1, Tgas, Tref):  # noqa: N802, N803
        return np.interp(Tref, *self.partition) / np.interp(Tgas, *self.partition)


def factory(case):
    """RADIS with its defaults, except that no line database is fetched."""
    count = len(case["wavenumber"])
    low, high = case["range"] / 100
    result = Factory(
        wavenum_min=low,
        wavenum_max=high,
        species="N2",
        isotope="1",
        Tref=float(case["reference_temperature"]),
        pressure=float(case["pressure"]) / 1e5,
        mole_fraction=1,
        path_length=1.0,
        verbose=False,
        warnings=False,
    )
    Factory.partition = (case["partition_temperature"], case["partition"])
    half_width = case["hwhm"] / 100 / (float(case["pressure"]) / 101325)
    frame = pd.DataFrame(
        {
            "wav": case["wavenumber"] / 100,
            "int": case["strength"] * 100,
            "A": case["einstein_a"],
            "airbrd": half_width,
            "selbrd": half_width,
            "El": case["lower_energy"] / 100,
            "Tdpair": np.full(count, 0.7),
            "Pshft": np.zeros(count),
            "gp": case["upper_degeneracy"],
            "gpp": case["lower_degeneracy"],
        }
    )
    frame.attrs.update({"id": 22, "iso": 1, "molecule": "N2", "molar_mass": float(case["molar_mass"])})
    result.df0, result.dataframe_type = frame, "pandas"
    result.reftracker = RefTracker()
    result.params.dbformat = "hitran"
    result._Nlines_calculated = count
    return result


def main(source, target):
    case = dict(np.load(source))
    radis = factory(case)
    temperature, thickness = case["temperature"], case["thickness"]
    radis.eq_spectrum(Tgas=float(case["slab_temperature"]))  # compiles and warms up
    slab_seconds, lines_seconds = [], []
    for _ in range(int(case["repeats"])):
        start = process_time()
        spectrum = radis.eq_spectrum(Tgas=float(case["slab_temperature"]))
        slab_seconds.append(process_time() - start)
        lines_seconds.append(radis.lines_summed - start)
    wavenumber, absorption = spectrum.get("abscoeff", wunit="cm-1")

    count = int(case["radis_slabs"])
    chosen = np.linspace(0, len(temperature) - 1, count).round().astype(int)
    start = process_time()
    slabs = [
        radis.eq_spectrum(Tgas=float(temperature[i]), path_length=float(thickness[i]) * 100) for i in chosen
    ]
    spectra = process_time() - start
    start = process_time()
    SerialSlabs(*slabs)
    path_seconds = spectra + process_time() - start
    np.savez(
        target,
        version=__version__,
        slab_seconds=slab_seconds,
        lines_seconds=lines_seconds,
        wavenumber=wavenumber * 100,
        absorption=absorption * 100,
        path_seconds=path_seconds,
        points=len(wavenumber),
        truncation=radis.params.truncation,
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
