from io import StringIO

import numpy as np
import pytest

from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.spectrum_text import compose_spectrum

WAVELENGTH = np.linspace(700e-9, 1200e-9, 501)
RADIANCE = blackbody_radiance(WAVELENGTH, 2000.0)


def test_a_spectrum_reads_back():
    columns = np.loadtxt(StringIO(compose_spectrum(WAVELENGTH, RADIANCE)), skiprows=2, unpack=True)
    assert columns[0] * 1e-10 == pytest.approx(WAVELENGTH, rel=1e-10)  # 1e-6 Angstrom
    assert columns[1] * 1e10 == pytest.approx(RADIANCE, rel=1e-8)  # 9 digits


def test_the_units_are_those_of_the_other_code():
    # A black body at 2000 K and 1 um emits 8.96 W cm-2 sr-1 um-1: c1L / lambda^5 = 11910.4 W cm-2 sr-1 um-1
    # at 1 um, over exp(14387.77 / 2000) - 1.
    lines = compose_spectrum(WAVELENGTH, RADIANCE).splitlines()
    row = next(line for line in lines[2:] if line.split()[0] == "10000.000000")
    assert float(row.split()[1]) == pytest.approx(8.96, rel=2e-3)
    assert len(lines) == 2 + len(WAVELENGTH)


def test_the_last_column_ends_at_the_integral():
    last = compose_spectrum(WAVELENGTH, RADIANCE).splitlines()[-1].split()
    assert float(last[2]) == pytest.approx(np.trapezoid(RADIANCE, WAVELENGTH) * 1e-4, rel=1e-8)
