import dataclasses

import numpy as np
import pytest
from scipy.special import i0

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.coloured import Coloured
from plasmapyro.diagnosis.fit.noise import FLICKER_MARGIN, NoiseModel, on_bins
from plasmapyro.diagnosis.fit.normal import FULL, gram
from plasmapyro.diagnosis.fit.weights import Noise, Weigher
from plasmapyro.diagnosis.gas import variations as vary
from plasmapyro.diagnosis.gas.templates import GasLibrary, line_groups, widened
from plasmapyro.diagnosis.select.screen import Candidate, Screen, angles, best_pairs
from plasmapyro.diagnosis.select.structures import Structure
from plasmapyro.diagnosis.select.thresholds import simulated
from plasmapyro.diagnosis.select.unknowns import SCALES, Unknowns
from plasmapyro.radiation.foreign import self_absorbed

FLOAT_RTOL = 1e-9


@pytest.fixture
def random():
    return np.random.default_rng(5)


@pytest.fixture
def block(random):
    """Three bins of four channels: noise, gas and value, dense covariance."""
    variance = random.uniform(0.5, 2.0, (3, 4))
    gas, value = random.normal(size=(2, 3, 4))
    flicker, gain = np.array([[0.3, 0.0, 2.0], [0.7, 1.1, 0.0]])
    dense = np.zeros((12, 12))
    for at in range(3):
        part, one, other = slice(4 * at, 4 * at + 4), gas[at], value[at]
        dense[part, part] = np.diag(variance[at])
        dense[part, part] += flicker[at] * np.outer(one, one) + gain[at] * np.outer(other, other)
    return Noise(variance, flicker, gain), (gas, value), dense


def test_weights_are_the_inverse_of_the_covariance(block, random):
    noise, shared, dense = block
    rows = random.normal(size=(3, 4, 2))
    expected = np.linalg.solve(dense, rows.reshape(12, 2))
    assert np.allclose(Weigher(noise, *shared)(rows).reshape(12, 2), expected, rtol=FLOAT_RTOL)
    assert np.allclose(Weigher(noise, *shared)(rows[..., 0]).ravel(), expected[:, 0], rtol=FLOAT_RTOL)
    root = Weigher(noise, *shared).root(rows)
    assert np.allclose(root.T @ root, rows.reshape(12, 2).T @ expected, rtol=FLOAT_RTOL)


def test_shapes_of_a_course_are_shared_by_the_channels_of_a_bin(block, random):
    """Against the dense covariance: each shape by itself, in proportion to the value."""
    noise, (gas, value), dense = block
    course, shapes, rows = (
        np.array([0.5, 0.0, 2.0]),
        random.normal(size=(2, 4)),
        random.normal(size=(3, 4, 2)),
    )
    for at in range(3):
        part = slice(4 * at, 4 * at + 4)
        for row in shapes:
            dense[part, part] += course[at] * np.outer(value[at] * row, value[at] * row)
    expected = np.linalg.solve(dense, rows.reshape(12, 2))
    whole = dataclasses.replace(noise, course=course, shapes=shapes)
    assert np.allclose(Weigher(whole, gas, value)(rows).reshape(12, 2), expected, rtol=FLOAT_RTOL)


def test_a_pattern_counts_as_one_column_per_channel(block, random):
    noise, shared, dense = block
    columns, row, residual = (
        random.normal(size=(3, 4, 2)),
        random.normal(size=(3, 4)),
        random.normal(size=(3, 4)),
    )
    matrix, vector = gram([columns], [(0, row)], [Weigher(noise, *shared)], [residual])
    pattern = (row[..., None] * np.eye(4)).reshape(12, 4)
    whole = np.concatenate([columns.reshape(12, 2), pattern], axis=1)
    assert np.allclose(matrix, whole.T @ np.linalg.solve(dense, whole), rtol=1e-7, atol=1e-9)
    assert np.allclose(vector, whole.T @ np.linalg.solve(dense, residual.ravel()), rtol=1e-7, atol=1e-9)


def test_columns_that_touch_few_bins_have_the_same_normal_matrix(random):
    """Told apart bin by bin: against a dense covariance, with two patterns of the channels."""
    bins, channels, count = 6, 9, 12
    columns = np.zeros((bins, channels, count))
    for at in range(1, bins):  # the first bin is touched by none, columns at the ends of two
        columns[at, :, 2 * at - 1 : 2 * at + 2] = random.normal(size=(channels, 3))
    rows, residual, gas = random.normal(size=(2, bins, channels)), *random.normal(size=(2, bins, channels))
    noise = Noise(random.uniform(0.5, 2.0, (bins, channels)), random.uniform(0.1, 0.5, bins))
    assert np.count_nonzero(np.any(columns, axis=1)) < FULL * bins * count
    matrix, vector = gram([columns], [(0, row) for row in rows], [Weigher(noise, gas)], [residual])
    dense = np.zeros((bins * channels, bins * channels))
    for at in range(bins):
        own = slice(at * channels, (at + 1) * channels)
        dense[own, own] = np.diag(noise.variance[at]) + noise.flicker[at] * np.outer(gas[at], gas[at])
    patterns = [(row[..., None] * np.eye(channels)).reshape(-1, channels) for row in rows]
    whole = np.concatenate([columns.reshape(-1, count), *patterns], axis=1)
    assert np.allclose(matrix, whole.T @ np.linalg.solve(dense, whole), rtol=1e-9, atol=1e-11)
    assert np.allclose(vector, whole.T @ np.linalg.solve(dense, residual.ravel()), rtol=1e-9, atol=1e-11)


def test_products_have_the_normal_matrix_of_the_columns_they_stand_for(random):
    """Of two instruments, one with few channels; patterns of the channels come after them."""
    columns, products, residuals, weighers, patterns = [], [], [], [], []
    for place, (bins, channels) in enumerate(((5, 2), (6, 9))):
        columns.append(random.normal(size=(bins, channels, 4)))
        columns[-1][:, :, 3] *= (np.arange(bins) == 1)[:, None]
        products.append((random.normal(size=(bins, channels, 3)), random.normal(size=(bins, 3, 7))))
        residuals.append(random.normal(size=(bins, channels)))
        gas = random.normal(size=(bins, channels))
        noise = Noise(random.uniform(0.5, 2.0, (bins, channels)), random.uniform(0.1, 0.5, bins))
        weighers.append(Weigher(noise, gas))
        patterns += [(place, random.normal(size=(bins, channels))) for _ in range(2)]
    dense = [
        np.concatenate([c, rows @ shares], axis=2)
        for c, (rows, shares) in zip(columns, products, strict=True)
    ]
    for found, expected in zip(
        gram(columns, patterns, weighers, residuals, products),
        gram(dense, patterns, weighers, residuals),
        strict=True,
    ):
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-11)


def screen_of(information, score, structures=()):
    count = len(score) - sum(s.columns.stop - s.columns.start for s in structures if not s.single)
    names = ("winE", "phi", "off1", "eps_slope")[:count]
    candidates = tuple(Candidate(CATALOGUE[name], {}) for name in names)
    return Screen(
        candidates, tuple(structures), np.array(score), np.array(information), np.ones(len(score)), None
    )


def test_scores_drawn_as_noise_have_the_information_as_covariance():
    information = np.array([[4.0, 1.0], [1.0, 9.0]])
    scores = simulated(screen_of(information, [0.0, 0.0]), 40_000, np.random.default_rng(1))
    assert np.allclose(np.cov(scores.T), information, rtol=0.05, atol=0.1)


def test_an_unknown_structure_of_one_column_has_the_evidence_of_a_gaussian():
    """ln B = -ln(1 + s^2 G)/2 + z^2/(G + 1/s^2)/2, by the integral over the amplitude."""
    from scipy.integrate import quad

    information, score = 5000.0, 300.0
    structure = Structure("pattern", "one", slice(0, 1))
    found = screen_of([[information]], [score], [structure])
    values = []
    for scale in SCALES:
        value, _ = quad(
            lambda x, s=scale: (
                np.exp(score * s * x - information * (s * x) ** 2 / 2 - x * x / 2) / np.sqrt(2 * np.pi)
            ),
            -12,
            12,
            limit=200,
        )
        values.append(np.log(value))
    expected = max(values) - np.log(len(SCALES))
    assert Unknowns(found)(np.array([score]))[0] == pytest.approx(expected, abs=1e-6)


def test_two_terms_together_gain_what_a_joint_fit_gains():
    information = np.array([[4.0, 1.0, 0.5], [1.0, 9.0, 0.2], [0.5, 0.2, 2.0]])
    score = np.array([0.8, -0.6, 0.1])
    ((gained, places, numbers), *_) = best_pairs(screen_of(information, score), np.ones(3))
    assert set(places) == {0, 1}
    joint = np.linalg.solve(information[:2, :2], score[:2])
    assert gained == pytest.approx(score[:2] @ joint, rel=FLOAT_RTOL)
    assert np.array(numbers)[np.argsort(places)] == pytest.approx(joint, rel=FLOAT_RTOL)


def test_each_pair_of_terms_is_given_once_and_best_first():
    information = np.array([[4.0, 1.0, 0.5], [1.0, 9.0, 0.2], [0.5, 0.2, 2.0]])
    found = screen_of(information, np.array([0.8, -0.6, 0.1]))
    pairs = best_pairs(found, np.ones(3), 9)
    assert len({frozenset(places) for _, places, _ in pairs}) == len(pairs) == 3
    assert sorted((gained for gained, *_ in pairs), reverse=True) == [gained for gained, *_ in pairs]
    assert best_pairs(found, np.array([1.0, 0.0, 0.0])) == []


def test_a_pair_whose_amplitudes_one_cannot_have_is_none():
    """Grains and reflected light only add; of opposite sign they would explain most."""
    information = 1e4 * np.array([[1.0, 0.9, 0.0], [0.9, 1.0, 0.0], [0.0, 0.0, 1.0]])
    score = information @ np.array([8.0, -6.0, 2.0])
    candidates = tuple(Candidate(CATALOGUE[name], {}) for name in ("refl", "particles", "edge1"))
    found = Screen(candidates, (), score, information, np.ones(3), None)
    ((_, places, _), *_) = best_pairs(found, np.ones(3))
    assert set(places) == {0, 2}


def test_parallel_directions_have_no_angle_and_independent_ones_a_right_one():
    assert angles(np.array([[1.0, 2.0], [2.0, 4.0]]))[0, 1] == pytest.approx(0.0, abs=1e-5)
    assert angles(np.diag([1.0, 5.0]))[0, 1] == pytest.approx(90.0)


def test_noise_of_a_mean_of_remembering_samples_is_that_of_the_simulated_mean(random):
    """Mean of n samples of a first-order process, by simulation."""
    from types import SimpleNamespace

    memory, count, trials = 0.6, 6, 200_000
    x = random.standard_normal(trials)
    total = x.copy()
    for _ in range(count - 1):
        x = memory * x + np.sqrt(1 - memory**2) * random.standard_normal(trials)
        total += x
    period = 0.5
    law = NoiseModel(0.0, 0.0, 0.0, 0.0, Coloured(0.0, 1.0, -period / np.log(memory)), 1.0)
    one = SimpleNamespace(
        channels=2, factor=None, pixels=np.ones(2), number=np.full((1, 2), count), value=np.ones((1, 2)),
        raw_moment=period * np.arange(9.0)[:, None], raw_bin=np.zeros(9, dtype=int),
        rounded=lambda level, number: 0 * level,
    )  # fmt: skip
    found = on_bins(law, one, np.ones((1, 2)), np.zeros(1)).flicker[0]
    # The formula takes the record as continuous: 4 % of six samples.
    assert found == pytest.approx(FLICKER_MARGIN * np.var(total / count), rel=0.06)


@pytest.fixture
def exponential():
    """Gas whose light goes as exp(b T), b by wavelength, at powers that heat it by 3 % each 10 %."""
    wavelength, change = np.linspace(7e-7, 11e-7, 41), 0.06 * np.arange(-6, 8)
    slope = 8 * (wavelength / 9e-7) ** 2  # b T, T of the condition
    log_power = np.log(80e3) + 0.1 * np.arange(-3, 4)
    hotter = 1.03 ** np.arange(-3, 4) - 1

    def light(at):
        return np.exp(np.outer(at, slope))

    return slope, GasLibrary(
        condition="80kW", power=80e3, wavelength=wavelength, slit_fwhm=1e-9, log_power=log_power,
        radiance=1.7 ** np.arange(-3, 4)[:, None] * light(hotter), group_name=("all",), group=light([0.0]),
        variation={"excitation": (np.array([-0.1, -0.05, 0, 0.05, 0.1]), light([-0.1, -0.05, 0, 0.05, 0.1]))},
        addition={}, weakest=light([-0.1])[0], core=(change, light(change)),
            systems=("all",), strength_modes=light([0.0]), shape_systems=("all",), shape_modes=light([0.0]),
            causes=("strength",), shape_causes=("width",),
    )  # fmt: skip


@pytest.mark.parametrize("power", [-0.2, 0.0, 0.2])
def test_a_ripple_of_an_exponential_is_a_bessel_function_at_every_power(exponential, power):
    """<exp(b T (1 + x sin))> = exp(b T) I0(b T x), T of the power; brightness alone does not heat."""
    slope, library = exponential
    kelvin = 1.03 ** (power / 0.1)
    found = library.factor("ripple", 0.15, power)
    np.testing.assert_allclose(found, i0(slope * kelvin * 0.15), rtol=1e-4)  # of the nearest temperature
    found = library.factor("core_temperature", -0.1, power)
    np.testing.assert_allclose(found, np.exp(-0.1 * slope * kelvin), rtol=1e-3)
    np.testing.assert_array_equal(library.factor("ripple", 0.0, power), 1.0)


def test_excitation_acts_less_on_hotter_atoms(exponential):
    slope, library = exponential
    found = library.factor("excitation", 0.05, 0.2)
    np.testing.assert_allclose(found, np.exp(0.05 / 1.03**2 * slope), rtol=1e-3)


@pytest.mark.parametrize("power", [-0.2, 0.0, 0.13, 0.2])
def test_excitation_acts_on_the_share_that_atoms_have_at_the_power(exponential, power):
    """Lines amid bands: where atoms shine e^(6 P) times as bright, bands e^P, they are more of the light."""
    slope, library = exponential
    library = dataclasses.replace(library, core=None)  # the temperature of the gas does not change
    share = 0.6 * np.linspace(0.0, 1.0, slope.size)
    atoms, bands = share * np.exp(6 * power), (1 - share) * np.exp(power)
    rows = np.array(
        [
            share * np.exp(6 * p) / (share * np.exp(6 * p) + (1 - share) * np.exp(p))
            for p in library.log_power - np.log(80e3)
        ]
    )
    at, brighter = library.variation["excitation"]
    seen = 1 + share * (brighter - 1)
    library = dataclasses.replace(library, share={"excitation": rows}, variation={"excitation": (at, seen)})
    found = library.factor("excitation", 0.05, power)
    expected = (atoms * np.exp(0.05 * slope) + bands) / (atoms + bands)
    np.testing.assert_allclose(found, expected, rtol=2e-3)  # shares are linear between the powers simulated


def test_one_power_alone_takes_another_as_hotter_gas(exponential):
    """By 0.3 of its relative change, as the powers of the default torch have it."""
    slope, library = exponential
    alone = dataclasses.replace(library, log_power=library.log_power[3:4], radiance=library.radiance[3:4])
    np.testing.assert_allclose(alone.power_factor(0.2), np.exp(0.06 * slope), rtol=1e-9)
    found = alone.factor("core_temperature", 0.1, 0.2)
    np.testing.assert_allclose(found, np.exp(0.1 * 1.06 * slope), rtol=1e-9)
    bare = dataclasses.replace(alone, core=None)
    np.testing.assert_allclose(bare.power_factor(0.2), np.exp(0.2), rtol=1e-15)


def test_a_line_absorbs_itself_as_a_uniform_slab():
    depth = np.array([0.0, 1e-6, 1.0, 50.0])
    kept = self_absorbed(np.ones(4), depth, 1.0)
    assert np.allclose(kept, [1.0, 1.0 - 5e-7, 1 - np.exp(-1), 0.02], rtol=1e-9)


def test_a_warmer_wall_changes_nothing_beyond_the_layer():
    distance = np.linspace(0, 0.1, 101)
    temperature = 350 + 5650 * np.tanh(distance / 2e-3)
    warm = vary.warmer_wall(distance, temperature, 1600.0, 5e-3)
    assert warm[0] == 1600.0
    assert np.array_equal(warm[distance >= 5e-3], temperature[distance >= 5e-3])
    assert (np.diff(warm) >= -1e-9).all()


def test_lines_keep_their_light_behind_the_slit(axis):
    histogram = vary.SlitHistogram(np.array([8.0e-7, 9.003e-7]), axis, 0.75e-9)
    seen = histogram(np.array([2.0, 3.0]))
    assert np.trapezoid(seen, axis) == pytest.approx(5.0, rel=1e-4)
    peak = 2.0 / (0.75e-9 / 2.3548 * np.sqrt(2 * np.pi))
    assert seen[np.abs(axis - 8e-7) < 1e-9].max() == pytest.approx(peak, rel=0.01)


def test_a_wider_slit_adds_variances(axis):
    narrow = np.exp(-(((axis - 9e-7) / 0.4e-9) ** 2) / 2)
    wide = widened(axis, narrow, 0.3e-9)
    expected = 0.4 / 0.5 * np.exp(-(((axis - 9e-7) / 0.5e-9) ** 2) / 2)
    assert np.abs(wide - expected).max() < 1e-6


def test_groups_of_lines_add_up_to_the_spectrum(axis, radiation):
    light = radiation["80kW"]["gas_radiance_component_slit"].values
    names, rows = line_groups(axis, ["O I", "N I", "N2 1P"], light)
    assert np.allclose(rows.sum(axis=0), light.sum(axis=0), rtol=1e-12, atol=0)
    assert len(names) == len(rows) == len(set(names))
    assert "O I 777 nm" in names


def test_scores_are_drawn_from_a_covariance_that_rounding_left_indefinite():
    """Weakly determined fits err by 1e-4 in what they project out: an eigenvalue of -2e-4 is none."""
    random = np.random.default_rng(8)
    vectors = np.linalg.qr(random.standard_normal((6, 6)))[0]
    information = vectors @ np.diag([-2e-4, 0.5, 1, 1, 1.5, 2]) @ vectors.T
    found = simulated(screen_of(information, np.zeros(6)), 200_000, np.random.default_rng(1))
    # 200 000 draws know a covariance to some 0.3 % of the variances.
    assert np.cov(found.T) == pytest.approx(information, abs=0.02)
