"""The tables of lines against others, and the light of lines against its limits."""

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.identification.species import catalogue
from plasmapyro.refraction import vacuum_wavelength

BY_NAME = {one.name: one for one in catalogue()}
MERCURY = "lamp/mercury_sansonetti_1996"


def test_hydrogen_to_uranium():
    elements = {one.element for one in catalogue() if " I" in one.name}
    assert len(elements) >= 75
    assert {"H", "Li", "Na", "K", "Rb", "Cs", "Mg", "Ca", "Sr", "Ba", "Fe", "W", "Re", "U"} <= elements


def test_wavelengths_agree_with_other_lists():
    """Lines of argon and mercury lamps, of other origin."""
    for table, name, least in (("lamp/argon_nist", "Ar I", 0.7), (MERCURY, "Hg I", 0.5)):
        place = tables.load(table)["wavelength_air"]
        near = np.abs(BY_NAME[name].wavelength[:, None] - place).min(axis=0)
        assert np.mean(near < 0.01e-9) > least, name
        assert not np.any((near > 0.01e-9) & (near < 0.2e-9)), name


@pytest.mark.parametrize(
    ("name", "lines", "ratio"),
    [  # [nm], strengths in LS coupling: C. W. Allen, Astrophysical Quantities (1973), par. 24
        ("Ca II", (849.8023, 854.2091, 866.2141), (1, 9, 5)),
        ("Na I", (588.9950, 589.5924), (2, 1)),
        ("K I", (766.4899, 769.8965), (2, 1)),
    ],
)
def test_multiplets_have_the_strengths_of_their_coupling(name, lines, ratio):
    own = BY_NAME[name]
    place = [int(np.abs(own.wavelength - one * 1e-9).argmin()) for one in lines]
    strength = own.probability[place] * own.wavelength[place] ** 3
    assert np.abs(own.wavelength[place] - np.array(lines) * 1e-9).max() < 0.01e-9
    np.testing.assert_allclose(strength / strength.sum(), np.array(ratio) / np.sum(ratio), atol=0.03)


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


def test_heads_of_two_sub_bands_lie_where_their_constants_say():
    """0-0 of BO and CaO: origins and B of both levels of Huber & Herzberg, NIST Chemistry WebBook."""
    for name, origin, upper, lower in (
        ("BO alpha", 23646.43, 1.4018, 1.7737),
        ("BO alpha", 23521.3, 1.4018, 1.7737),
        ("CaO infrared", 11548.84, 0.40524, 0.44283),
    ):
        head = vacuum_wavelength(BY_NAME[name].wavelength)
        expected = 1e-2 / (origin + (upper + lower) ** 2 / 4 / (lower - upper))
        assert np.abs(head - expected).min() < 0.05e-9, name


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
