"""What every spectrometer does to the light of a furnace, against light sent through one pixel by pixel."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.effects.scene import Output
from plasmapyro.diagnosis.fit import no_plasma
from plasmapyro.radiation.planck import blackbody_radiance

AXIS = np.arange(500e-9, 1000e-9, 0.5e-9)
RESPONSE = 1e-6 * np.exp(-(((AXIS - 780e-9) / 150e-9) ** 2)) * (1 + 0.2 * np.sin(AXIS / 30e-9))
HOT, SURFACE = 1173.15, 973.15  # [K] source of the calibration, and what is measured
SLIT = 10e-9  # [m] standard deviation
STRAY = 0.004
MIDDLE = slice(150, -150)  # beyond, light from outside the table is missing


def through(light, slit=0.0, stray=0.0):
    """Counts of light (P,) through a slit of some width [m], with a share of the mean count everywhere."""
    counts = RESPONSE * light
    if slit:
        kernel = np.exp(-(((AXIS[:, None] - AXIS) / slit) ** 2) / 2)
        counts = kernel @ counts / kernel.sum(axis=1)
    return counts + stray * counts.mean()


def measured(**what):
    """Radiance (P,) that a calibration makes of a surface, and the counts of the calibration."""
    surface, source = (blackbody_radiance(AXIS, kelvin) for kelvin in (SURFACE, HOT))
    rate = through(source, **what)
    return through(surface, **what) * source / rate, rate, source / rate


def test_a_slit_is_what_its_counts_make_it():
    seen, rate, _ = measured(slit=SLIT)
    formula = no_plasma._slit(AXIS, rate, HOT, 2e-9).light
    scene = SimpleNamespace(wavelength=AXIS, temperature=np.full((1, 1), SURFACE), glow=np.ones(AXIS.size))
    scene.but = lambda glow: glow
    change = formula(scene, SLIT * 1e9)[0, 0] - 1
    truth = seen / blackbody_radiance(AXIS, SURFACE) - 1
    # of second order, and with the slope of what the slit has blurred already
    assert np.abs(truth[MIDDLE]).max() > 0.01
    assert change[MIDDLE] == pytest.approx(truth[MIDDLE], abs=0.1 * np.abs(truth[MIDDLE]).max())


def test_stray_light_of_test_and_calibration_partly_cancel():
    seen, rate, factor = measured(stray=STRAY)
    formula = no_plasma._stray_of_both(AXIS, rate).output
    plain = blackbody_radiance(AXIS, SURFACE)
    output = Output(
        "spectrometer", np.zeros(1), np.inf, plain[None], factor, plain, plain, np.ones(plain.size), AXIS
    )
    truth = seen / plain - 1
    assert np.abs(truth).max() > 0.1
    # the share is of counts that hold the stray light already
    assert formula(output, STRAY)[0] / plain - 1 == pytest.approx(truth, abs=3 * STRAY * np.abs(truth).max())
