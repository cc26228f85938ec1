"""Names of lines that a model leaves, and effects that can be kept."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis import stage
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.effects.gas import lines_of
from plasmapyro.diagnosis.fit.terms import AMPLITUDE, terms_of
from plasmapyro.diagnosis.report.foreign import certain, lines_lacking, species_left, terms_of_jet

FWHM = 1.0  # [nm]
RUBIDIUM = [(780.027, 1.0), (794.760, 0.5), (775.765, 0.02), (775.944, 0.03)]  # air [nm], resonance lines


def gaussians(axis, lines, strength):
    return strength * sum(b * np.exp(-4 * np.log(2) * ((axis - a * 1.000275) / FWHM) ** 2) for a, b in lines)


@pytest.fixture(scope="module")
def library():
    axis = np.arange(740.0, 1040.0, 0.2)
    base = gaussians(axis, [(777.194, 1.0), (777.417, 0.7), (777.539, 0.4)], 1e9)
    return SimpleNamespace(wavelength=axis * 1e-9, base=base, slit_fwhm=FWHM * 1e-9)


def test_lines_that_are_left_get_a_name_and_an_effect_that_reads_back(library):
    axis = np.arange(745.0, 1035.0, 0.5)
    sigma = np.full(axis.size, 1e5)
    noise = np.random.default_rng(4).normal(0, 1e5, axis.size)
    found = species_left(axis * 1e-9, gaussians(axis, RUBIDIUM, 1e7) + noise, sigma, library)
    assert [one["species"] for one in found] == ["Rb I"]
    effect = found[0]["effect"]
    (term,) = terms_of([effect], CATALOGUE)
    assert term.setting.effect.id == "lines Rb I"
    # light of both lines over a tenth of the triplet's; Rb I has 3 % of its light elsewhere in the range
    assert effect["amplitude"] == pytest.approx(1e7 * 1.55 / (0.1 * 1e9 * 2.1), rel=0.15)
    assert 0 < effect["uncertainty"] < 0.05 * effect["amplitude"]


def test_noise_that_is_left_gets_none(library):
    axis = np.arange(745.0, 1035.0, 0.5)
    noise = np.random.default_rng(5).normal(0, 1e5, axis.size)
    assert species_left(axis * 1e-9, noise, np.full(axis.size, 1e5), library) == []


def test_a_line_that_the_simulated_gas_lacks_gets_the_name_of_its_species(library):
    """Frames of gas, surface and rubidium; the comparison saw one of its lines, or one beside none."""
    axis = np.arange(745.0, 1035.0, 0.15)
    gas = np.interp(axis * 1e-9, library.wavelength, library.base)
    light = gas + 2e8 * np.exp((axis - 900) / 300) + gaussians(axis, RUBIDIUM, 3e7)
    time = np.arange(-5.0, 40.0)
    frames = light + np.random.default_rng(6).normal(0, 2e6, (time.size, axis.size))
    frames[:, 700] = np.nan
    spectrometer = SimpleNamespace(wavelength=axis * 1e-9, time=time, integration_time=1.0, sound=frames)
    library.group, library.group_name = np.array([library.base]), ["O I 777 nm"]
    model = SimpleNamespace(
        record=SimpleNamespace(instrument={"spectrometer": spectrometer}.get),
        instruments=[SimpleNamespace(weight=None, wavelength=axis[::9] * 1e-9)],
        library=library,
        off=35.0,
    )

    def asked(*places, light=frames):
        spectrometer.sound = light
        lines = [SimpleNamespace(wavelength=place * 1e-9, strength=1.0) for place in places]
        systems = [SimpleNamespace(name="O I 777 nm", ratio=1.0)]
        return lines_lacking(model, SimpleNamespace(lines=lines, systems=systems))

    (found,) = asked(780.3)
    assert found["species"] == "Rb I" and certain(found) and found["with_sample"] is False
    (term,) = terms_of_jet([found])  # for the simulation of the condition
    assert term.setting.id == "lines Rb I" and list(term.uncertainty) == [AMPLITUDE]
    (later,) = asked(780.3, light=frames - (time < 0)[:, None] * gaussians(axis, RUBIDIUM, 3e7))
    assert later["with_sample"] is True and not [*terms_of_jet([later])]
    assert found["lines"] == pytest.approx([780.027e-9, 794.760e-9], abs=0.05e-9)
    assert found["effect"]["amplitude"] == pytest.approx(3e7 * 1.55 / (0.1 * 1e9 * 2.1), rel=0.15)
    assert asked(850.0) == asked() == []
    library.base = library.base * 1.2  # a simulation that errs by a fifth has no oxygen too much
    library.group = np.array([library.base])
    assert [one["species"] for one in asked(780.3, 777.5)] == ["Rb I"]


def test_a_species_without_lines_in_the_table_is_no_effect():
    with pytest.raises(KeyError):
        lines_of("Xx I")
    with pytest.raises(ValueError, match="unknown"):
        terms_of([{"id": "lines Xx I", "amplitude": 1.0}], CATALOGUE)


ARGON = [(763.51, 1.0), (794.82, 0.3), (811.53, 1.0), (842.46, 0.6), (912.3, 0.8), (922.45, 0.2)]  # air [nm]


def test_an_atom_of_the_catalogue_keeps_its_name(record, diagnosis_of, monkeypatch):
    """Lines of argon are found by their places as well; that must not free their light from its effect."""
    effect = {"id": "lines Ar I", "amplitude": 1.0, "uncertainty": 0.1}
    by_place = {"species": "Ar I", "probability": 1.0, "rivals": [], "with_sample": False, "effect": effect}
    monkeypatch.setattr(stage, "lines_lacking", lambda *_: [{**by_place, "lines": [811.5e-9]}])
    test = record()
    lines = gaussians(test.wavelength.values * 1e9, ARGON, 0.4 * float(test.spectral_radiance[:10].mean()))
    burning = (test.spectrum_time.values < float(test.attrs["plasma_off_time"]))[:, None]
    test["spectral_radiance"] = test.spectral_radiance + burning * lines
    found = diagnosis_of(test)
    assert found.report["verdict"]["named"] == ["Ar"]
    assert not any("Ar I" in one for one in found.report["simulation"]["sentences"])
