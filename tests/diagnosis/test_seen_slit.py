"""The width of a slit by lines of atoms, of spectra that are sums of normal laws."""

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

from plasmapyro.diagnosis.fit.slit import _Line, seen_slit, with_lines
from plasmapyro.diagnosis.gas.library import _of_scale
from plasmapyro.record.record import Instrument, Record

FWHM = 0.5e-9  # [m] as stated
SIGMA = FWHM / 2.3548
NARROW = 15e-12  # [m] standard deviation of lines as they are emitted
BANDS = 3.0  # times as bright as simulated
KEPT = ["gas_radiance_slit"]


@pytest.fixture(scope="module")
def gas():
    """Places [m] and strengths of lines of an atom, and of a band."""
    random = np.random.default_rng(5)
    atom = 707e-9 + 12e-9 * np.arange(16) + random.uniform(-2e-9, 2e-9, 16)
    band = np.sort(random.uniform(700e-9, 900e-9, 500))
    return (atom, np.exp(random.normal(0, 0.5, 16))), (band, 0.016 * np.exp(random.normal(0, 0.3, 500)))


def behind(where, lines, sigma):
    """Light at some wavelengths of lines behind a Gaussian of a standard deviation [m]."""
    return sum(size * norm.pdf(where, at, sigma) for at, size in zip(*lines, strict=True))


@pytest.fixture(scope="module")
def radiation(gas):
    fine = np.arange(698e-9, 902e-9, 6e-12)
    light = np.stack([behind(fine, lines, NARROW) for lines in gas])
    return with_lines(
        xr.Dataset(
            {
                "gas_radiance_component": (("component", "wavelength"), light),
                "gas_radiance_slit": ("wavelength_slit", np.ones(3)),
            },
            coords={"component": ["N I", "N2 1P"], "wavelength": fine},
        ),
        KEPT,
    )


def record(gas, wider=0.0, moved=0.0, pixel=0.15e-9, strengths=0.0, begin=-20.0, noise=0.002, first=702e-9):
    """A record whose slit function has a further standard deviation `wider` [m], on a scale that is off."""
    random = np.random.default_rng(7)
    pixels = np.arange(first, 898e-9, pixel)
    (atom, bright), band = gas
    bright = bright * np.exp(strengths * random.standard_normal(bright.size))
    sigma = np.sqrt(NARROW**2 + SIGMA**2 + wider**2)
    light = behind(pixels + moved, (atom, bright), sigma) + BANDS * behind(pixels + moved, band, sigma)
    time = np.arange(begin, 10.0)
    frames = light + noise * light.mean() * random.standard_normal((time.size, light.size))
    instrument = Instrument(
        "spectrometer", time, 0.5, frames, np.zeros(frames.shape, dtype=int), wavelength=pixels
    )
    attributes = {"spectrometer_fwhm": FWHM}
    return Record(0.0, 10.0, (-5.0, -1.0), 0.85, 0.03, 1.0, 0.02, (instrument,), attributes=attributes)


@pytest.mark.parametrize("pixel", [0.07e-9, 0.4e-9])
@pytest.mark.parametrize("wider", [0.0, 0.1e-9, 0.3e-9])
def test_a_slit_is_seen_through_strengths_that_err(gas, radiation, wider, pixel):
    found = seen_slit(record(gas, wider, pixel=pixel, strengths=0.3), radiation)
    assert found.lines >= 10
    assert abs(found.extra - (wider / 1e-9) ** 2) < 2 * found.error
    assert found.ratio == pytest.approx(np.hypot(1, wider / SIGMA), rel=0.03)


def test_a_scale_that_is_off_by_more_than_a_slit_widens_nothing(gas, radiation):
    found = seen_slit(record(gas, moved=0.9e-9), radiation)
    assert abs(found.extra) < found.error


def test_pixels_that_no_spectrum_reaches_say_nothing(gas, radiation):
    found = seen_slit(record(gas, 0.1e-9, moved=0.9e-9, first=400e-9), radiation)
    assert abs(found.extra - 0.01) < found.error


def test_a_finer_slit_is_said_and_is_no_wider_one(gas, radiation):
    rows = record(gas)
    coarse = rows.attributes | {"spectrometer_fwhm": 1.3 * FWHM}
    found = seen_slit(Record(**{**vars(rows), "attributes": coarse}), radiation)
    assert found.ratio == pytest.approx(1 / 1.3, rel=0.02) and found.extra < -5 * found.error


def test_noise_makes_it_uncertain_and_not_wrong(gas, radiation):
    quiet, noisy = (seen_slit(record(gas, 0.2e-9, noise=one), radiation) for one in (0.002, 5.0))
    assert noisy.error > 1.5 * quiet.error
    assert abs(noisy.extra - 0.04) < 3 * noisy.error


@pytest.mark.parametrize(("bright", "seen"), [(0.0, False), (0.002, False), (0.05, True)])
def test_a_line_counts_by_ten_standard_errors_of_its_light(bright, seen):
    """Where a slit of 3 nm had drowned all, lines told 0.6 +- 0.3: flat light takes any width."""
    axis = 800e-9 + np.arange(-4e-9, 4e-9, FWHM / 40)
    emitted = np.stack([norm.pdf(axis, 800e-9, NARROW) * 1e-9, 1 + (axis - 800e-9) / 4e-9])
    pixels = 800e-9 + np.arange(-1.2e-9, 1.25e-9, 0.1e-9)
    light = bright * norm.pdf(pixels, 800e-9, SIGMA) * 1e-9 + 2.0 + 0.1 * (pixels - 800e-9) / 4e-9
    assert _Line(pixels, light, np.full(pixels.size, 1e-3), axis, emitted, FWHM).seen == seen


def test_without_light_before_the_injection_or_lines_there_is_none(gas, radiation):
    assert seen_slit(record(gas, begin=0.0), radiation) is None
    dark = radiation.assign(atomic_radiance=0 * radiation["atomic_radiance"])
    assert seen_slit(record(gas), dark) is None
    assert seen_slit(record(gas), radiation.drop_vars("atomic_radiance")) is None


@pytest.mark.parametrize(
    "moved", [lambda x: (2e-6 * x, 0 * x), lambda x: (0 * x, 2e-6 * x * ((x - 9.5e-7) / 2.5e-7) ** 2)]
)
def test_lines_of_one_atom_and_a_bent_dispersion_may_be_off_by_what_wavelengths_err(moved):
    """Errors of the simulation hold both to a hundredth: by differences of neighbours they missed 4 %, many
    times the noise of a line, which a shifted scale then explained (0.11 nm where 0.03 were)."""
    axis, sigma = np.arange(7e-7, 12e-7, 1.5e-10), 0.75e-9 / 2.3548

    def light(centres, of_atom):
        alone, bend = moved(axis)
        at = (axis - of_atom * alone - bend)[:, None]
        return np.exp(-(((at - centres) / sigma) ** 2) / 2).sum(axis=1)

    atoms = [np.array([7.774e-7, 8.446e-7, 9.263e-7]), np.array([8.216e-7, 8.683e-7, 9.392e-7])]
    plain = [np.exp(-(((axis[:, None] - one) / sigma) ** 2) / 2).sum(axis=1) for one in atoms]
    change = light(atoms[0], True) + light(atoms[1], False) - sum(plain)
    systems, modes = _of_scale(axis, np.array(["O I", "N I"]), np.array(plain), 0.75e-9)
    assert systems[-2:] == ("O I", "N I") and len(systems) == len(modes)
    factor, *_ = np.linalg.lstsq(modes.T, change, rcond=None)
    assert np.abs(change - factor @ modes).max() < 0.02 * np.abs(change).max()
    assert np.sum(factor**2) < 0.03  # a tenth of what is stated
