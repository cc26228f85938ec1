"""Loggers: coarse steps, which are no fault; unequal steps and lost samples, which are."""

import numpy as np
import pytest
from small_laboratory import SLIT_FWHM

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.build import base_model
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.select.selection import select
from plasmapyro.diagnosis.select.structures import seen_by
from plasmapyro.record.record import record_of

BOTH = {"pyrometer": None, "spectrometer": None}
CODES = 2**12  # of the whole range; the noise is a tenth of a step of the cool surface
LOST = 2  # samples
TENTH = 0.1  # of a step between samples: which of them lie behind the end tells no more
PERIODS, SIZE = 6.3, 0.01  # along the signal, and of the gain [1]


@pytest.fixture(scope="module")
def diagnosed(record, response, laboratory):
    """Base fit and choice for a test whose signals `change` (signal (t,) -> (t,))."""
    library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=SLIT_FWHM)

    def of(change, alone=False):
        test = record(noise=0.2).isel(wavelength=slice(None, None, 8))  # it is all about signals
        test = test.drop_dims("spectrum_time") if alone else test
        for name in ("signal_wide", "signal_narrow"):
            test[name].values = change(test[name].values)
        with np.errstate(all="ignore"):
            base = fit_base(base_model(record_of(test, BOTH), library, laboratory.calibration, response))
            return base, select(base, CATALOGUE, draws=300)

    return of


def test_coarse_steps_are_noise_and_no_samples_are_lost_to_them(diagnosed):
    base, found = diagnosed(lambda signal: np.round(CODES * signal / signal.max()) * signal.max() / CODES)
    assert found.status == "null"
    pyrometer = base.model.instruments[0]
    expected = np.bincount(pyrometer.raw_bin[pyrometer.raw_bin >= 0])
    assert (pyrometer.number >= 0.9 * expected[:, None]).all()


def test_unequal_steps_are_a_fault_along_the_signal(diagnosed):
    _, found = diagnosed(
        lambda signal: signal * (1 + SIZE * np.sin(2 * np.pi * PERIODS * signal / signal.max()))
    )
    assert seen_by(found.unknown_class) == {"instrument": "pyrometer", "axis": "signal"}


@pytest.mark.parametrize("level", [0.26, 0.6])
def test_an_amplifier_of_two_ranges_is_a_fault_along_the_signal(diagnosed, level):
    """Above a share of the largest signal it amplifies 1.5 % less, on the way up and on the way down."""
    _, found = diagnosed(lambda signal: signal * (1 - 0.015 * (signal > level * signal.max())))
    assert seen_by(found.unknown_class) == {"instrument": "pyrometer", "axis": "signal"}


def test_lost_samples_are_a_fault_of_the_clock_from_then_on(diagnosed):
    """Samples of 0.2 s are lost while the surface heats and not counted."""

    def late(signal):
        place = np.arange(signal.size)
        return np.interp(place + LOST * (place > signal.size // 3), place, signal)

    _, found = diagnosed(late)
    classes = found.steps[0].screen.structures
    assert "clock" in classes[int(np.argmax(found.steps[0].unknown))].id


@pytest.mark.parametrize("alone", [False, True])
@pytest.mark.parametrize("early", [2, -2])
def test_a_clock_that_is_off_is_found_with_its_size_and_sign(diagnosed, early, alone):
    """Signals of whole samples too early or too late, the end of the gas with them: all that a pyrometer
    alone knows of it, and a slope there knows nothing of an end that lies beyond the next sample."""

    def moved(signal):
        return np.interp(np.arange(signal.size) + early, np.arange(signal.size), signal)

    base, found = diagnosed(moved, alone)
    step = float(np.median(np.diff(base.model.record.instruments[0].time)))
    (clock,) = [one for one in found.final.settings if one.id == "clock"]
    # Gains that wander from 3 s to 3 s take up some of a second's shift of a heating surface.
    assert clock.amplitude == pytest.approx(early * step, abs=2 * TENTH * step)
