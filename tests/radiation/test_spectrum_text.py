import numpy as np
import pytest

from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.spectrum_text import compose_spectrum, parse_spectrum

WAVELENGTH = np.linspace(700e-9, 1200e-9, 501)
RADIANCE = blackbody_radiance(WAVELENGTH, 2000.0)


def test_a_spectrum_reads_back():
    wavelength, radiance = parse_spectrum(compose_spectrum(WAVELENGTH, RADIANCE))
    assert wavelength == pytest.approx(WAVELENGTH, rel=1e-10)  # 1e-6 Angstrom
    assert radiance == pytest.approx(RADIANCE, rel=1e-8)  # 9 digits


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


def test_four_columns_hold_the_radiance_in_the_third():
    text = "NEQAIR\n wavelength a b c\n 7000.0 9 1.5 8\n 7001.0 9 2.5 8\n 7001.0 9 2.5 8\n 7002.0 9 3.5 8\n"
    wavelength, radiance = parse_spectrum(text)
    assert wavelength == pytest.approx([700e-9, 700.1e-9, 700.2e-9])
    assert radiance == pytest.approx([1.5e10, 2.5e10, 3.5e10])


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("", "line 3: no spectrum after the two header lines"),
        ("7000 1\n7001\n", "line 4: 2 columns expected, 1 found"),
        ("7000\n", "line 3: 2, 3 or 4 columns expected, 1 found"),
        ("7000 1\n7001 1.0E\n", "line 4: not a number among '7001 1.0E'"),
        ("7000 1\n7001 nan\n", "line 4: wavelength and radiance must be finite"),
        ("7000 1\n6999 1\n", "line 4: wavelengths must increase; got 7000.0 then 6999.0 A"),
    ],
)
def test_a_garbled_spectrum_is_refused_with_the_line(body, message):
    with pytest.raises(ValueError, match=message):
        parse_spectrum("one\ntwo\n" + body)
