"""Pixels that are brighter and fainter in turn, as two read-out chains leave them: bins average that away."""

from dataclasses import replace

import numpy as np
import pytest

from plasmapyro.diagnosis.select.pixels import BY_CHANCE, NAMES, PIXELS, chance_of_kinds, in_turn
from plasmapyro.diagnosis.select.structures import seen_by
from plasmapyro.record.record import Instrument, Record

OFF, SCATTER = 60.0, 0.004  # [s]; of the calibration of single pixels


def spectra(seed, turn=0, apart=0.0, pixels=801):
    """A surface that warms behind a gas with narrow lines, of pixels of two kinds in turns of some."""
    random, place = np.random.default_rng(seed), np.arange(pixels)
    time = np.arange(-3.0, 80.0, 0.7)
    surface = np.where(time < OFF, -np.expm1(-np.maximum(time, 0) / 9), np.exp(-(time - OFF) / 4))
    shape = np.exp(-(((place - 500) / 400) ** 2)) * (1 + SCATTER * random.standard_normal(pixels))
    kinds = 1 + apart * (-1.0) ** (place // turn) if turn else np.ones(pixels)
    lines = np.convolve(random.exponential(size=pixels) ** 3, np.hanning(9) / 200, "same")
    flicker = (time < OFF) * (1 + 0.01 * random.standard_normal(time.size))
    light = (surface[:, None] * shape + flicker[:, None] * lines) * kinds
    light *= 1 + 0.003 * random.standard_normal(light.shape)
    flag = np.zeros(light.shape, dtype=int)
    wavelength = np.linspace(700e-9, 1e-6, pixels)
    return Instrument("spectrometer", time, 0.3, light, flag, wavelength=wavelength)


@pytest.mark.parametrize("turn", [1, 2, 7])
@pytest.mark.parametrize("pixels", [801, 1024])
def test_pixels_of_two_kinds_are_told_however_they_take_turns(turn, pixels):
    """Also where each is of the other kind than the next, the fastest wave there is."""
    assert chance_of_kinds(spectra(1, turn, 0.004, pixels=pixels), OFF) < BY_CHANCE


def test_neither_lines_nor_the_calibration_of_pixels_takes_turns():
    chances = [chance_of_kinds(spectra(seed), OFF) for seed in range(40)]
    assert min(chances) > 1e-3 and np.mean(np.array(chances) < 0.1) < 0.2


@pytest.mark.parametrize(("height", "told"), [(0.0028, False), (0.006, True)])
def test_a_fringe_that_a_flat_field_leaves_is_told_from_a_third_of_a_per_cent_on(height, told):
    frames = spectra(1)
    fringe = 1 + height * np.sin(2 * np.pi * np.arange(801) / 6.6)
    assert (chance_of_kinds(replace(frames, value=frames.value * fringe), OFF) < BY_CHANCE) == told


def test_lines_of_the_gas_are_no_pattern_of_pixels():
    """A comb of lines is taken for what it is, the light of the plasma, since it goes when that ends."""
    comb = spectra(2)
    lit = comb.value + (comb.time < OFF)[:, None] * (np.arange(801) % 8 == 0)
    assert chance_of_kinds(Instrument(comb.name, comb.time, 0.3, lit, comb.flag), OFF) > BY_CHANCE


def test_pixels_that_are_left_out_in_turn_are_no_pattern():
    """Put side by side, those on both sides of a gap left a step in a light that rises over the pixels."""
    frames = spectra(4)
    hot = np.arange(801) % 35 > 28
    rising = frames.value * np.exp(np.arange(801) / 300)
    gaps = replace(frames, value=rising, flag=np.where(hot, 1, frames.flag))
    assert chance_of_kinds(gaps, OFF) > 1e-3


@pytest.mark.parametrize("apart, found", [(0.0, None), (0.01, PIXELS)])
def test_it_is_unknown_in_the_spectrometer_along_its_wavelengths(apart, found):
    frames = spectra(3, 2, apart)
    record = Record(0.0, OFF, (), 0.8, 0.03, 1.0, 0.03, (frames,))
    assert in_turn(record) == found
    assert in_turn(replace(record, instruments=())) is None
    assert seen_by(PIXELS) == {"instrument": "spectrometer", "axis": "wavelength"} and PIXELS in NAMES
