"""Effects that the twin hides: each does what its name says, to the instrument and in the phase it should."""

import dataclasses
import json

import numpy as np
import pytest
from invented import TEMPERATURE, as_dataset, plasma, scene
from scipy.constants import Boltzmann, c, h
from twin import campaign, gas, hidden, liars, light
from two_bands import RESPONSE

SEED = 5
GAS = plasma()
SCENE = scene()
TIME = campaign.readings(SCENE)[0]
FRAMES = campaign.exposures(SCENE, np.arange(-20, 330.01, campaign.TICK))[0]
PIXELS = SCENE.spectrometer.wavelength
TOUCHES = {  # what an effect changes; the others change both
    "pyrometer": "winD winD_sl off1 off2 nonlin_p phi edge1 edge2 resp_long edge_p clock channel_drift",
    "spectrometer": "winE winE_sl off_s nonlin_s wshift lsf stray second edge_s etalon fibre_step fibre_wave",
}
NEEDS_SAMPLE = (
    "refl eps_slope eps_T eps_ox torchglow grad edge_p edge_s NaK CaII CN bl particles emittance_band"
)
ENDS_WITH_PLASMA = (
    "refl gas_drift P_eff T_exc T_vib ripple selfabs contin bl particles NaK CaII CN Cu Ar scat"
)


def output(effects, base=SCENE):
    changed = base
    for name, amplitude, shape in effects:
        changed = hidden.hide(changed, name, amplitude, GAS, shape)
    return campaign.clean_output(changed, RESPONSE, [(1.0, as_dataset(GAS.total, GAS.centres))], SEED)


BASE = output([])


def ratio(name, amplitude, shape=None):
    """Signals and count rates with an effect over those without."""
    return [new / old for new, old in zip(output([(name, amplitude, shape)]), BASE, strict=True)]


def test_catalogue_is_rich_and_what_lies_outside_is_not_in_it():
    assert len(hidden.CATALOGUE) >= 40 and len(hidden.OUTSIDE) == 6
    assert not set(hidden.CATALOGUE) & set(hidden.OUTSIDE)


@pytest.mark.parametrize("name", hidden.EFFECTS)
def test_effect_of_no_size_changes_nothing_and_of_unit_size_what_it_should(name):
    nothing, unit = output([(name, 0.0, None)]), output([(name, hidden.EFFECTS[name].unit, None)])
    for old, same in zip(BASE, nothing, strict=True):
        np.testing.assert_allclose(same, old, rtol=1e-9, atol=1e-12 * np.abs(old).max())
    moved = [np.abs(new - old) > 1e-9 * np.abs(old).max() for old, new in zip(BASE, unit, strict=True)]
    for instrument, part in zip(("pyrometer", "spectrometer"), moved, strict=True):
        others = [words for other, words in TOUCHES.items() if other != instrument]
        assert part.any() == (name not in " ".join(others).split()), instrument
    if name in NEEDS_SAMPLE.split():
        assert not moved[0][:, TIME < 0].any() and not moved[1][FRAMES < -1].any()
    if name in ENDS_WITH_PLASMA.split():
        assert not moved[0][:, TIME > 301].any() and not moved[1][FRAMES > 302].any()


def test_two_effects_on_one_hook_both_act():
    both = output([("winE", 0.1, None), ("winE_sl", 0.1, {"power": 1.0})])
    at = np.searchsorted(FRAMES, 320.0)
    expected = 0.9 * (1 - 0.1 * 0.95e-6 / PIXELS)
    np.testing.assert_allclose(both[1][at] / BASE[1][at], expected, rtol=1e-9)


def test_deposits_grow_with_the_exposure_and_stay():
    signal, rate = ratio("winD", 0.2)
    assert signal[0, np.searchsorted(TIME, 150)] == pytest.approx(0.9, rel=1e-9)
    np.testing.assert_allclose(signal[:, TIME >= 300], 0.8, rtol=1e-9)
    np.testing.assert_allclose(rate, 1.0, rtol=1e-12)


def test_emittance_slope_turns_about_950_nm():
    _, rate = ratio("eps_slope", 0.3)
    after = rate[FRAMES > 310]  # no gas: the surface alone
    np.testing.assert_allclose(
        after, np.broadcast_to(1 + 0.3 * (PIXELS - 0.95e-6) * 1e6, after.shape), rtol=1e-9
    )


def test_oxidation_does_not_come_back_but_a_reversible_emittance_does():
    for name, comes_back in (("eps_ox", False), ("eps_T", True)):
        signal, _ = ratio(name, 0.1, {"tau_s": 20.0} if name == "eps_ox" else None)
        kelvin = campaign.history(SCENE.sample, TIME, 300.0)
        late = np.searchsorted(TIME, 329.0)
        assert kelvin[late] < 1300
        assert (signal[1, late] < signal[1, np.searchsorted(TIME, 290.0)] - 0.01) == comes_back


def test_spread_of_temperature_adds_half_its_square_times_the_curvature():
    _, rate = ratio("grad", 40.0, {"spot_ratio": 0.6})
    at = np.searchsorted(FRAMES, 328.0)
    kelvin = float(campaign.history(SCENE.sample, np.array([FRAMES[at]]), 300.0)[0])
    x = h * c / (PIXELS * Boltzmann * kelvin)
    expected = 1 + (0.6 * 40.0) ** 2 / 2 * (x**2 - 2 * x) / kelvin**2
    np.testing.assert_allclose(
        rate[at], expected, rtol=3e-4
    )  # Wien; the fourth power of the spread is left out


def test_reflections_come_with_what_the_surface_does_not_absorb():
    for name, amplitude in (("refl", 1.0), ("torchglow", 0.01)):
        added = []
        for emittance in (0.85, 0.40):
            base = scene(sample=dataclasses.replace(SCENE.sample, emittance=emittance))
            more, none = output([(name, amplitude, None)], base), output([], base)
            added.append((more[1] - none[1])[(FRAMES > 1) & (FRAMES < 5)].mean())
        assert added[1] / added[0] == pytest.approx(0.60 / 0.15, rel=1e-6), name


def test_a_mirror_that_reflected_all_would_double_the_gas():
    still = scene(emittance=lambda wavelength, kelvin, time: 1e-9)
    more, none = output([("refl", 1.0, {"diffuse": 0.0})], still), output([], still)
    early = (TIME > 0.5) & (TIME < 290)
    np.testing.assert_allclose((more[0] / none[0])[:, early], 2.0, rtol=1e-5)


def test_glow_of_the_walls_fades_when_the_plasma_is_off():
    more = output([("torchglow", 0.02, {"glow_k": 1500.0, "decay_s": 10.0})])[0] - BASE[0]
    at = [np.searchsorted(TIME, when) for when in (290.0, 310.0, 320.0)]
    burning, later, last = more[1, at]
    assert later / burning == pytest.approx(np.exp(-1.0), rel=1e-6)
    assert last / burning == pytest.approx(np.exp(-2.0), rel=1e-6)


def test_matter_from_the_surface_comes_when_it_is_hot():
    _, rate = output([("NaK", 5.0, None)])
    line = np.argmin(np.abs(PIXELS - 819.7e-9))
    more = (rate - BASE[1])[:, line] / BASE[1][np.searchsorted(FRAMES, 2.0), line]
    early, late = more[np.searchsorted(FRAMES, 10.0)], more[np.searchsorted(FRAMES, 280.0)]
    assert late > 20 * early > 0


def test_drift_of_the_gas_ends_at_the_stated_size():
    no_surface = scene(emittance=lambda wavelength, kelvin, time: 1e-9)
    more, none = output([("gas_drift", 0.2, None)], no_surface), output([], no_surface)
    ratio_of = (more[0] / none[0])[0]
    assert ratio_of[np.searchsorted(TIME, 150.0)] == pytest.approx(1.1, rel=1e-6)
    assert ratio_of[np.searchsorted(TIME, 300.0)] == pytest.approx(1.2, rel=1e-6)


def test_calibration_ratio_moves_one_band_only():
    signal, _ = ratio("phi", 0.05)
    np.testing.assert_allclose(signal[0], np.exp(0.05), rtol=1e-12)
    np.testing.assert_allclose(signal[1], 1.0, rtol=1e-12)


def test_shifted_edge_to_the_red_loses_light_of_a_hot_plasma_line_but_not_the_other_band():
    for name, band in (("edge1", 0), ("edge2", 1)):
        signal, _ = ratio(name, 5.0)
        assert np.abs(signal[band] - 1).max() > 1e-3
        np.testing.assert_allclose(signal[1 - band], 1.0, rtol=1e-12)


@pytest.mark.parametrize(("centred", "early"), [(True, 0.0), (False, 0.025)])
def test_centred_exposures_lie_where_their_time_says(centred, early):
    base = scene(centred_exposures=centred)
    faded = output([("winE", 0.3, None)], base)[1] / output([], base)[1]
    steady = (FRAMES > 100) & (FRAMES < 290)
    mean_time = (1 - faded[steady].mean(axis=1)) * 300.0 / 0.3
    np.testing.assert_allclose(mean_time, FRAMES[steady] - early, atol=2e-3)  # flicker weighs instants by 1 %


def test_late_clock_shows_what_happened_later():
    signal, _ = output([("clock", 1.0, None)])
    np.testing.assert_allclose(signal[:, 30:-1], BASE[0][:, 31:], rtol=1e-6)


def test_offset_and_compression_are_of_the_stated_size():
    plus = output([("off1", 0.2, None)])[0] - BASE[0]
    window = (TIME >= 0) & (TIME <= 6)
    np.testing.assert_allclose(plus[0], 0.2 * BASE[0][0, window].mean(), rtol=1e-9)
    bent, _ = ratio("nonlin_p", 0.02)
    assert bent[1].min() == pytest.approx(0.98, rel=1e-9) and bent[1].argmin() == BASE[0][1].argmax()


def test_stray_light_keeps_the_sum_of_all_pixels():
    _, rate = output([("stray", 0.05, None)])
    np.testing.assert_allclose(rate.sum(axis=1), BASE[1].sum(axis=1), rtol=1e-9)
    assert np.ptp(rate, axis=1).max() < np.ptp(BASE[1], axis=1).max()


def test_wider_slit_and_shift_move_light_but_do_not_make_it():
    spacing = PIXELS[1] - PIXELS[0]
    centres = np.arange(0.84e-6, 0.86e-6, gas.BIN)
    edges = np.append(centres, centres[-1] + gas.BIN) - gas.BIN / 2
    line = gas.narrow(centres, [850.0], [1.0])
    fine = np.arange(0.845e-6, 0.855e-6, spacing / 50)
    for fwhm in (0.75e-9, np.hypot(0.75e-9, np.sqrt(8 * np.log(2)) * 0.3e-9)):
        assert np.trapezoid(light.through_slit(edges, line, fine, fwhm), fine) == pytest.approx(1.0, rel=1e-3)
    moved = output([("wshift", 1.0, None)])[1] - BASE[1]
    dark = FRAMES < -1
    assert np.abs(moved[dark]).max() > 0.1 * BASE[1][dark].max()


def test_excitation_follows_boltzmann_in_a_uniform_gas():
    kelvin = np.full(TEMPERATURE.size, 6000.0)
    uniform = gas.Gas(
        GAS.centres, GAS.systems, GAS.radiance, GAS.distance, kelvin,
        GAS.table_temperature, GAS.table_density,
    )  # fmt: skip
    changed = uniform.excited(1.05) / uniform.total
    line = np.argmin(np.abs(GAS.centres - 777.408e-9))
    energy = h * c * 86629.0 * 100  # O I 5P above the ground state, NIST
    expected = np.exp(energy / (Boltzmann * 6000.0) * (1 - 1 / 1.05))
    assert changed[line] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("kelvin", [4500.0, 6000.0])
def test_molecules_that_warm_up_share_their_light_among_more_levels(kelvin):
    """A gas of fixed composition: Boltzmann's factor over the partition function of a rigid oscillator."""
    uniform = dataclasses.replace(
        GAS,
        temperature=np.full(TEMPERATURE.size, kelvin),
        table_density={name: np.ones_like(values) for name, values in GAS.table_density.items()},
    )
    energy, quantum, warmer = 61000.0, 2359.0, 1.05  # [cm-1] of N2; Huber & Herzberg
    factor = h * c * 100 / Boltzmann

    def emitted(at):
        return np.exp(-factor * energy / at) * -np.expm1(-factor * quantum / at) / at

    expected = emitted(warmer * kelvin) / emitted(kelvin)
    found = uniform._heating("N2 1P", energy, warmer - 1)
    # Without the partition function 9 % more; anharmonicity and triplet states weigh 1 %.
    assert found == pytest.approx(expected, rel=0.015)


def test_hotter_gas_gains_in_lines_and_ripple_is_its_mean():
    line = np.argmin(np.abs(GAS.centres - 777.408e-9))
    smooth = np.argmin(np.abs(GAS.centres - 1.03e-6))
    hot, rippled = GAS.hotter(0.05) / GAS.total, GAS.rippled(0.05) / GAS.total
    assert hot[line] > 1.5 and hot[line] > hot[smooth]
    assert abs(rippled[line] - 1) < 0.3 * abs(hot[line] - 1)
    np.testing.assert_allclose(GAS.hotter(0.0), GAS.total, rtol=1e-9)


def test_vibration_moves_light_between_bands_of_n2_and_keeps_atoms():
    warm = GAS.vibrating(1.2) / GAS.total
    at = {nm: np.argmin(np.abs(GAS.centres - nm * 1e-9)) for nm in (755.0, 885.0, 777.408)}
    assert warm[at[755.0]] > 1.02 > warm[at[885.0]]  # v' = 3 and 4 against v' = 1
    assert warm[at[777.408]] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("depth", "kept"),
    [(1e-3, 1 - 1e-3 / np.sqrt(8)), (0.1, 1 - 0.1 / np.sqrt(8) + 0.01 / (6 * np.sqrt(3)) - 1e-3 / 48)],
)
def test_self_absorption_has_the_thin_limit(depth, kept):
    # Series of (1 - exp(-x))/x over a Gaussian profile: sum of (-tau)^n / ((n + 1)! sqrt(n + 1)).
    assert gas.escape(depth) == pytest.approx(kept, rel=1e-5)


def test_oxygen_band_lies_where_the_sky_shows_it():
    wavelength = np.linspace(755e-9, 775e-9, 2001)
    band = gas.oxygen_band(wavelength)
    # Fraunhofer's A band: 759.4 to 762.1 nm in air for the R branch and the head of the P branch.
    assert 759.5e-9 < wavelength[np.argmax(band)] < 762.0e-9
    assert band[wavelength < 758.5e-9].max() < 0.01 and 0.05 < band[wavelength > 766e-9].max() < 0.9
    assert band.max() == pytest.approx(1.0, rel=0.02)


def test_power_between_two_files_lies_between_their_spectra():
    from invented import spectra

    kept = spectra()
    between = kept.at(85e3).sum(axis=0)
    assert (between >= kept.radiance[1].sum(axis=0) * (1 - 1e-12)).all()
    np.testing.assert_allclose(kept.at(80e3), np.maximum(kept.radiance[1], 1e-30), rtol=1e-12)
    with pytest.raises(ValueError, match=r"power must lie in \[50, 130\] kW; got 140 kW"):
        kept.at(140e3)


def test_what_is_hidden_goes_into_the_truth_only():
    changed = hidden.hide(SCENE, "winE", 0.05, GAS)
    test, truth = campaign.record(changed, RESPONSE, [(1.0, as_dataset(GAS.total, GAS.centres))], SEED)
    assert json.loads(truth.attrs["hidden"]) == [{"effect": "winE", "amplitude": 0.05, "shape": {}}]
    assert "winE" not in str(test.attrs) and "hidden" not in test.attrs


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("win", 0.1), "effect must be one of refl"),
        (("winE", 0.9), r"winE: amplitude must lie in \[0, 0.4\]; got 0.9"),
        (("winE_sl", 0.1, {"slope": 1.0}), "winE_sl: shape has no slope; it has power"),
    ],
)
def test_what_cannot_be_hidden_is_refused(arguments, message):
    name, amplitude, *shape = arguments
    with pytest.raises(ValueError, match=message):
        hidden.hide(SCENE, name, amplitude, GAS, *shape)


@pytest.fixture(scope="module")
def quiet():
    return record(None)


def record(noise):
    changed = liars.lie(SCENE, noise) if noise else SCENE
    return campaign.record(changed, RESPONSE, [(1.0, as_dataset(GAS.total, GAS.centres))], SEED)[0]


def residual(test):
    """Residual of the wide band in standard deviations while the sample is steady."""
    sigma = np.hypot(0.003 * BASE[0][0], 5e-11)
    return ((test.signal_wide.values - BASE[0][0]) / sigma)[(TIME > 100) & (TIME < 290)]


def test_noise_is_as_stated_unless_told_otherwise(quiet):
    assert residual(quiet).std() == pytest.approx(1.0, abs=0.15)
    assert residual(record("louder_1.3")).std() == pytest.approx(1.3, abs=0.2)


def test_remembering_noise_remembers_and_heavy_tails_are_heavy():
    noise = residual(record("remembering"))
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(0.5, abs=0.2)
    assert noise.std() == pytest.approx(1.0, abs=0.2)
    wide = [liars.LIARS["heavy_tailed"](SCENE).draw(np.random.default_rng(1), (100000,), 0)]
    assert np.mean(np.abs(wide[0]) > 4) > 5e-3  # normal: 6e-5


def test_counts_of_every_kind_of_noise_keep_their_size(quiet):
    loud = record("louder_1.3")
    steady = (FRAMES > 100) & (FRAMES < 290)
    spread = [np.median(np.diff(test.counts.values[steady], axis=0).std(axis=0)) for test in (quiet, loud)]
    assert spread[1] / spread[0] == pytest.approx(1.3, abs=0.1)


def test_files_are_spoiled_as_said():
    dropped, full, spiky = (record(name) for name in ("dropped", "saturated", "spiky"))
    assert dropped.counts.isnull().all("wavelength").any() and dropped.signal_wide.isnull().any()
    assert float(full.counts.max()) == 65535.0
    assert np.mean(np.abs(residual(spiky)) > 6) == pytest.approx(0.006, abs=0.008)
    with pytest.raises(ValueError, match="noise must be one of louder_1.1"):
        liars.lie(SCENE, "quieter")
