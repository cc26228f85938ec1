"""Errors with a memory: their simulated records, and the covariance that the base model gives them."""

from types import SimpleNamespace

import numpy as np
import pytest
from small_laboratory import SLIT_FWHM

from plasmapyro.diagnosis.fit import persistent
from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.build import base_model
from plasmapyro.diagnosis.fit.coloured import Coloured, coloured
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.record.record import record_of

PERIOD, TIME, SIZE, WHITE = 0.1, 0.8, 2e-3, 1e-3


@pytest.fixture
def random():
    return np.random.default_rng(11)


def remembering(random, count):
    """An Ornstein-Uhlenbeck record, step by step."""
    keep = np.exp(-PERIOD / TIME)
    value = np.empty(count)
    value[0] = random.standard_normal()
    for at in range(1, count):
        value[at] = keep * value[at - 1] + np.sqrt(1 - keep**2) * random.standard_normal()
    return SIZE * value


def test_two_bands_tell_what_they_share_below_the_heating_and_beside_their_own_noise(random):
    count, bins = 4000, 80
    heating = 5 * -np.expm1(-np.arange(count) * PERIOD / 100)
    chosen, phase, found = np.ones(count, dtype=bool), np.zeros(count, dtype=int), []
    for _ in range(9):
        shared = remembering(random, count) + WHITE * random.standard_normal(count)
        bands = heating + shared + 3e-3 * random.standard_normal((2, count))
        one = coloured(*bands, np.zeros(count), chosen, phase, PERIOD, 6.0)
        found.append(one.of_mean(np.array([bins]), PERIOD)[0])
    # Of the mean of 8 s, by the formula that the next test but one checks. One record knows it to 40 %.
    expected = Coloured(WHITE**2, SIZE**2, TIME).of_mean(np.array([bins]), PERIOD)[0]
    assert np.median(found) == pytest.approx(expected, rel=0.4)


def test_no_common_noise_is_found_where_there_is_none(random):
    one, other = 3e-3 * random.standard_normal((2, 2000))
    whole = np.ones(2000, dtype=bool)
    found = coloured(one, other, np.zeros(2000), whole, np.zeros(2000, dtype=int), PERIOD, 6.0)
    assert found.total < 0.15 * 3e-3**2  # the products of 700 independent differences scatter by 4 %


def test_variance_of_a_mean_is_that_of_the_simulated_record(random):
    record = remembering(random, 200_000)
    for number in (1, 8, 80):
        means = record[: 200_000 // number * number].reshape(-1, number).mean(axis=1)
        expected = Coloured(0.0, SIZE**2, TIME).of_mean(np.array([number]), PERIOD)[0]
        # 12500 memories long: 1 % twice over; the formula takes the record as continuous, 6 % at a sample.
        assert means.var() == pytest.approx(expected, rel=0.08)


@pytest.fixture
def spectrometer():
    return SimpleNamespace(
        kind="spectrometer", channels=90, known=None, wavelength=np.linspace(7e-7, 1e-6, 90)
    )


def covariance_of(errors, time, sizes):
    """Covariance of the errors of all (time, channel), of independent numbers of the given sizes."""
    rows, channel = errors.basis(time)
    return np.einsum("tm,cm,m,sm,dm->tcsd", rows, channel, sizes**2, rows, channel)


def test_gains_wander_with_their_memory_and_the_scale_is_smooth_over_wavelength(spectrometer):
    errors = persistent.persistent(spectrometer, 0.0, 360.0)
    sizes = np.array([one.sigma * (one.id != "wander_course") for one in errors.parameters])
    time = errors.knots[[2, 5]]
    found = covariance_of(errors, time, sizes)
    wander = persistent.WANDER["spectrometer"] ** 2
    decay = np.exp(-(time[1] - time[0]) / (persistent.MEMORY * 360.0))
    # The scale over wavelength is the same at both times and drops out of the difference.
    assert found[0, 40, 0, 40] - found[0, 40, 1, 40] == pytest.approx(wander * (1 - decay), rel=1e-9)
    apart = spectrometer.wavelength[60] - spectrometer.wavelength[20]
    smooth = sum(np.exp(-0.5 * (apart / one) ** 2) for one in persistent.SCALE_LENGTHS)
    expected = wander + persistent.SCALE_ERROR**2 * smooth
    assert found[0, 20, 0, 60] == pytest.approx(
        expected, rel=0.02
    )  # modes of 1 % of the variance are left out


def test_the_course_over_wavelength_wanders_as_slowly_as_gains_do(spectrometer):
    errors = persistent.persistent(spectrometer, 0.0, 360.0)
    sizes = np.array([one.sigma * (one.id == "wander_course") for one in errors.parameters])
    time = np.linspace(0.0, 360.0, persistent.COURSE_KNOTS)[[3, 8]]
    found = covariance_of(errors, time, sizes) / persistent.COURSE_WANDER**2
    wavelength = spectrometer.wavelength
    parts = [np.exp(-0.5 * ((wavelength[60] - wavelength[20]) / one) ** 2) for one in (25e-9, 60e-9, 200e-9)]
    decay = np.exp(-(time[1] - time[0]) / (persistent.MEMORY * 360.0))
    # Shapes of a thousandth of the first are left out; knots of gains lie beside those of the course.
    assert found[0, 40, 0, 40] == pytest.approx(1.0, abs=0.1)
    assert found[0, 20, 0, 60] == pytest.approx(np.mean(parts), abs=0.05)
    assert found[0, 20, 1, 60] == pytest.approx(np.mean(parts) * decay, abs=0.03)


def test_the_scale_has_as_many_modes_whatever_the_bins_of_the_spectra(spectrometer):
    """Else two tests of one campaign state it at other wavelengths, and share nothing of it but its ends."""
    counts = set()
    for channels in (27, 53, 160):  # by its own bins the eighth mode is 1.01e-4 or 0.8e-4 of the first
        spectrometer.channels, spectrometer.wavelength = channels, np.linspace(7.6e-7, 1.02e-6, channels)
        errors = persistent.persistent(spectrometer, 0.0, 360.0)
        counts.add(sum(one.id == "smooth_spectrometer" for one in errors.parameters))
    assert len(counts) == 1


def test_pixels_that_a_test_lost_leave_the_scale_between_them_as_open_as_it_is(spectrometer):
    """Saturated from 800 to 910 nm: three places of the stated scale lie between two channels."""
    every = np.linspace(7.55e-7, 1.025e-6, 160)
    points = persistent.scale_ends(every)[0] + np.linspace(0, 2.6e-7, 8)
    laws = []
    for channels in (every, every[(every < 8e-7) | (every > 9.1e-7)]):
        spectrometer.channels, spectrometer.wavelength = channels.size, channels
        errors = persistent.persistent(spectrometer, 0.0, 360.0)
        smooth = [one.id == "smooth_spectrometer" for one in errors.parameters]
        modes = errors.channel[:, smooth]
        np.testing.assert_allclose(
            persistent.scale_at(channels, channels, modes, errors.lengths), modes, atol=1e-9
        )
        there = persistent.scale_at(points, channels, modes, errors.lengths)
        laws.append(there @ there.T)
    assert np.linalg.eigvalsh(laws[1])[0] > 0.1 * np.linalg.eigvalsh(laws[0])[0]
    np.testing.assert_allclose(
        laws[1], laws[0], atol=0.02
    )  # of 2: modes below 1e-4 of the first are left out


def test_bands_wander_together_and_apart():
    errors = persistent.persistent(SimpleNamespace(kind="pyrometer", channels=2, known=None), -20.0, 340.0)
    sizes = np.array([parameter.sigma for parameter in errors.parameters])
    found = covariance_of(errors, errors.knots[:1], sizes)[0, :, 0]
    assert found[0, 0] + found[1, 1] - 2 * found[0, 1] == pytest.approx(persistent.WANDER["ratio"] ** 2)
    assert (found.sum()) / 4 == pytest.approx(persistent.WANDER["pyrometer"] ** 2)


def test_modes_of_the_scale_that_are_left_out_make_no_temperature_surer(record, laboratory, monkeypatch):
    """What a wrong temperature looks like over wavelength is smooth, but not among the first few modes."""

    def sigma():
        both = {"pyrometer": None, "spectrometer": None}
        library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=SLIT_FWHM)
        found = base_model(record_of(record(), both), library, laboratory.calibration, laboratory.response)
        solution = fit_base(found).solution
        hot = solution.state.knots > 1300.0
        return np.sqrt(np.diag(solution.covariance)[: hot.size][hot])

    plain = sigma()
    monkeypatch.setattr(persistent, "LEAST", persistent.LEAST / 1000)
    np.testing.assert_allclose(sigma(), plain, rtol=0.03)


def test_what_gains_do_between_their_knots_is_noise_of_bins(random, monkeypatch):
    """Ornstein-Uhlenbeck records beside the straight lines through their values at the knots."""
    step, fine, memory = 10.0, 100, 100.0
    knots = np.arange(0.0, 401.0, step)
    errors = SimpleNamespace(
        knots=knots, parameters=[SimpleNamespace(id="wander_pyrometer", sigma=2e-3)] * knots.size
    )
    keep, missed = np.exp(-step / fine / memory), []
    for _ in range(60):
        value = np.empty((knots.size - 1) * fine + 1)
        value[0] = random.standard_normal()
        for at in range(1, value.size):
            value[at] = keep * value[at - 1] + np.sqrt(1 - keep**2) * random.standard_normal()
        line = np.interp(np.arange(value.size), np.arange(0, value.size, fine), value[::fine])
        missed.append((value - line)[:-1].reshape(-1, fine))
    of_all, own, course = persistent.unresolved(errors, [0.0, step])
    assert own == pytest.approx([0.0, 0.0]) and course == pytest.approx([0.0, 0.0])
    errors.parameters.append(SimpleNamespace(id="wander_900 nm", sigma=1e-3))
    assert persistent.unresolved(errors, [0.0, step])[1] == pytest.approx(of_all / 4)
    errors.parameters.append(SimpleNamespace(id="wander_course", sigma=2e-3))
    monkeypatch.setattr(persistent, "COURSE_KNOTS", knots.size)
    assert persistent.unresolved(errors, [0.0, step])[2] == pytest.approx(of_all)
    # 2400 intervals; the mean over one is that of a bin that begins where a knot is.
    found = np.mean(np.square(missed)), np.mean(np.mean(missed, axis=2) ** 2)
    assert np.sqrt(of_all) == pytest.approx(2e-3 * np.sqrt(found), rel=0.05)
