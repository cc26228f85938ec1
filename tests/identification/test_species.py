"""The tables of lines against others, and the light of lines against its limits."""

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.identification.species import catalogue

BY_NAME = {one.name: one for one in catalogue()}


def test_hydrogen_to_uranium():
    elements = {one.element for one in catalogue() if " I" in one.name}
    assert len(elements) >= 75
    assert {"H", "Li", "Na", "K", "Rb", "Cs", "Mg", "Ca", "Sr", "Ba", "Fe", "W", "Re", "U"} <= elements


def test_wavelengths_agree_with_other_lists():
    """Lists of other origin: argon and mercury lamps, impurities of a jet; 0.01 nm is their own rounding."""
    for table, column in (("diagnosis/impurity_lines", "species"), ("lamp/mercury_sansonetti_1996", None)):
        rows = tables.load(table)
        for k, place in enumerate(rows["wavelength_air"]):
            own = BY_NAME[rows[column][k] if column else "Hg I"]
            if place < 1.1e-6 and not (column is None and own.wavelength.size < 20):
                assert np.abs(own.wavelength - place).min() < 0.01e-9, (own.name, place)


@pytest.mark.parametrize(
    ("name", "head"),
    [  # R. W. B. Pearse & A. G. Gaydon, The Identification of Molecular Spectra (1976) [nm]
        ("CN violet", 388.34),
        ("CN violet", 421.60),
        ("C2 Swan", 516.52),
        ("AlO blue-green", 484.21),
        ("SiO A-X", 241.38),
        ("OH A-X", 306.36),
        ("NH A-X", 336.00),
        ("TiO gamma", 705.45),
        ("N2+ first-negative", 391.44),
        ("CO Angstrom", 519.82),
    ],
)
def test_heads_lie_where_others_saw_them(name, head):
    own = BY_NAME[name]
    assert np.abs(own.wavelength - head * 1e-9).min() < own.error


def test_thin_lines_follow_boltzmann_and_thick_ones_planck():
    iron, temperature = BY_NAME["Fe I"], 5000.0
    boltzmann = iron.probability / iron.wavelength * np.exp(-SECOND_RADIATION * iron.upper / temperature)
    thin = iron.light(temperature, 1e-6)
    np.testing.assert_allclose(thin, boltzmann / boltzmann.max(), rtol=1e-5)
    sodium = BY_NAME["Na I"]
    pair = [int(np.abs(sodium.wavelength - place).argmin()) for place in (588.995e-9, 589.592e-9)]
    first, second = sodium.light(3000.0, 1e5)[pair]
    # radiance of a black body times the width of a line, which grows with the wavelength: the two differ by
    # 0.4 % in wavelength^-4 and 0.8 % in the exponential
    place = sodium.wavelength[pair]
    planck = place**-4 * np.exp(-SECOND_RADIATION / place / 3000.0)
    assert first / second == pytest.approx(planck[0] / planck[1], rel=2e-3)
