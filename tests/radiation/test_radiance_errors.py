"""Modes of the error of the radiance, against the engine with changed strengths."""

from dataclasses import replace

import numpy as np
import pytest

from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import ACCURACY, atomic_lines
from plasmapyro.radiation.band_systems import SYSTEMS
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.lines import BAND
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.slit import slit_wavelengths, through_slit
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.radiation.systems import component_uncertainty
from plasmapyro.radiation.uncertainty import (
    COMMON,
    LEAST_STRENGTH,
    OF_BAND,
    WIDTH,
    error_modes,
    gained_by_width,
)
from plasmapyro.sightline.stage import equilibrium_sightline

SLIT = 0.75e-9
RANGE = (765e-9, 800e-9)  # O I 777, N2 1P 2-0 and others
LINEAR = 0.05  # of the largest change: absorption and Doppler widths, which the modes leave out
PATH = {
    "path_distance": np.linspace(0.0, 0.05, 4),
    "temperature": np.array([6000.0, 7000.0, 6500.0, 6000.0]),
    "number_density": {
        name: np.full(4, density)
        for name, density in (
            dict.fromkeys(SPECIES, 1e18) | {"N": 2e22, "O": 1e22, "N2": 3e22, "e-": 2e22}
        ).items()
    },
}


@pytest.fixture(scope="module")
def engine():
    """Path, line lists, and spectrum behind the slit (C, K) of any lists."""
    grid = log_grid(RANGE, 40000)
    reach = (1 / 830e-9, 1 / 740e-9)
    bands = SYSTEMS["N2 1P"].line_list(reach, lost_fraction=1e-4, reference_temperature=(6000.0,))
    path = gas_path(**PATH)
    wavelength = grid.wavelength[::-1]
    view = slit_wavelengths(wavelength, SLIT)

    def seen(lists):
        result = path_radiance(path, lists, grid)
        return result, through_slit(wavelength, result.radiance[:, ::-1], view, SLIT)

    return path, [atomic_lines("O I"), bands], view, seen


@pytest.fixture(scope="module")
def modes(engine):
    path, lists, view, seen = engine
    result, light = seen(lists)
    stated = component_uncertainty(result.components, lists)
    return result, light, error_modes(path, result.thin_lines, view, SLIT, result.components, light, stated)


def of(modes, system, cause):
    """Modes (M, K) of a system and cause in W m-2 sr-1 m-1."""
    result, light, found = modes
    mine = np.array([one == (system, cause) for one in zip(found.system, found.cause, strict=True)])
    return found.share[mine] * light[list(result.components).index(system)]


def nearest(rows, change):
    """The mode that is most like a change, and how far it is from it, over its largest value."""
    off = [np.abs(row - change).max() / np.abs(change).max() for row in rows]
    return min(off)


def test_a_multiplet_is_the_change_of_its_a_values(engine, modes):
    _, (oxygen, bands), _, seen = engine
    family = oxygen.family[np.argmin(np.abs(1 / oxygen.wavenumber - 777.6e-9))]
    size = np.sqrt(COMMON) * oxygen.strength_uncertainty * (oxygen.family == family)
    changed = seen([replace(oxygen, einstein_a=oxygen.einstein_a * (1 + size)), bands])[1]
    change = (changed - modes[1]).sum(axis=0)
    assert nearest(of(modes, "O I", "multiplet"), change) < LINEAR


def widened(oxygen, size):
    """The lines with Lorentz widths larger by a relative size."""
    names = ("natural_hwhm", "stark_hwhm", "van_der_waals_hwhm", "resonance_hwhm")
    return replace(oxygen, **{name: getattr(oxygen, name) * (1 + size) for name in names})


def test_a_width_is_the_change_of_its_half_widths(engine, modes):
    """The wings take what the centre loses; the Doppler width is not in the mode."""
    _, (oxygen, bands), _, seen = engine
    changed = seen([widened(oxygen, np.sqrt(COMMON) * WIDTH), bands])[1]
    assert nearest(of(modes, "O I", "width"), (changed - modes[1]).sum(axis=0)) < LINEAR


def test_wider_lines_that_absorb_themselves_shine_brighter():
    """A long path: the mode takes the gas as uniform and knows no Doppler width; half is asked for."""
    density = PATH["number_density"] | {"O": np.full(4, 5e22), "e-": np.full(4, 1e23)}
    path = gas_path(300 * PATH["path_distance"], PATH["temperature"], density)
    grid = log_grid((770e-9, 785e-9), 40000)
    wavelength, oxygen = grid.wavelength[::-1], atomic_lines("O I")
    view = slit_wavelengths(wavelength, SLIT)

    def seen(lines):
        result = path_radiance(path, [lines], grid)
        return result, through_slit(wavelength, result.radiance[:, ::-1], view, SLIT)

    result, light = seen(oxygen)
    place = list(result.components).index("O I")
    stated = component_uncertainty(result.components, [oxygen])
    found = error_modes(path, result.thin_lines, view, SLIT, result.components, light, stated)
    changed = seen(widened(oxygen, np.sqrt(COMMON) * WIDTH))[1][place]
    gained = (changed - light[place]).sum() / light[place].sum()
    assert gained > 0.03
    first = [cause for cause, system in zip(found.cause, found.system, strict=True) if system == "O I"]
    mode = found.share[np.array(found.system) == "O I"][first.index("width")]
    assert (mode * light[place]).sum() / light[place].sum() == pytest.approx(gained, rel=0.5)


@pytest.mark.parametrize("depth", [0.01, 0.5, 3.0, 30.0])
def test_a_wider_line_gains_what_the_integral_over_its_profile_does(depth):
    """A Lorentz line of unit half width out to 1e5 of them, the mean of half a per cent to either side."""
    away = np.concatenate([-np.geomspace(1e5, 1e-4, 40000), np.geomspace(1e-4, 1e5, 40000)])

    def light(width):
        return np.trapezoid(-np.expm1(-depth * width / (away**2 + width**2)), away)

    slope = np.log(light(1.005) / light(0.995)) / np.log(1.005 / 0.995)
    assert gained_by_width(depth) == pytest.approx(slope, abs=2e-3)


def test_a_band_is_the_change_of_its_strength(engine, modes):
    _, (oxygen, bands), _, seen = engine
    size = OF_BAND * max(bands.relative_uncertainty, LEAST_STRENGTH)
    number = 2 * BAND  # v' = 2 to v'' = 0, in the range
    assert (bands.family == number).any()
    scale = 1 + size * (bands.family == number)
    changed = seen([oxygen, replace(bands, einstein_a=bands.einstein_a * scale)])[1]
    change = (changed - modes[1]).sum(axis=0)
    assert nearest(of(modes, "N2 1P", "band"), change) < LINEAR


def test_classes_of_nist_are_the_errors_of_lines(modes):
    """What the modes of O I 777 say of its light: the class of its A values and the scale of all."""
    result, light, found = modes
    oxygen = list(result.components).index("O I")
    assert set(ACCURACY[word] for word in ("A", "B")) & set(atomic_lines("O I").strength_uncertainty)
    peak = int(np.argmax(light[oxygen]))
    mine = np.array([one == "O I" for one in found.system])
    assert 0.05 < np.sqrt(np.sum(found.share[mine, peak] ** 2)) < 0.15


def test_every_system_begins_with_its_strength_as_a_whole(modes):
    _, light, found = modes
    first = {}
    for system, cause, row in zip(found.system, found.cause, found.share, strict=True):
        first.setdefault(system, (cause, row))
    assert {cause for cause, _ in first.values()} == {"strength"}
    for _, row in first.values():
        assert np.ptp(row[row > 0]) < 1e-12


@pytest.mark.parametrize("temperature", [300.0, 6000.0], ids=["dark", "bright"])
def test_gas_of_any_brightness_has_finite_modes(temperature):
    """At room temperature no gas shines; at the end of the tables systems reach in by tails alone."""
    distance = np.linspace(0.0, 0.1, 4)
    line = equilibrium_sightline(distance, temperature + 0 * distance, 5000.0)
    found = line_of_sight_radiance(
        line, None, wavelength_range=(1180e-9, 1200e-9), grid_points=40000, slit_fwhm=0.5e-9
    )
    assert np.isfinite(found.error_share).all()
    assert found.sizes["error_mode"] > 30 if temperature > 5000 else found.sizes["error_mode"] == 0
