"""Spectrum files in every dialect hold the same numbers; what is lost is said to be lost."""

from datetime import datetime

import numpy as np
import pytest
import samples

from plasmapyro import contracts
from plasmapyro.readers.ocean import clipped, read_spectrum
from plasmapyro.readers.stage import check_test, read_test
from plasmapyro.readers.text import Refusal

FLOAT_RTOL = 1e-12
# Air and vacuum wavelengths of Ar I and O I as listed in the NIST Atomic Spectra Database.
PAIRS_NM = {763.5106: 763.7208, 777.194: 777.408, 811.5311: 811.7542, 912.2967: 912.5471}


@pytest.mark.parametrize("form", samples.FORMS)
def test_each_dialect_gives_the_same_spectrum(tmp_path, form):
    path = tmp_path / "a.txt"
    path.write_bytes(samples.spectrum(form))
    found = read_spectrum(path)
    np.testing.assert_allclose(found.wavelength, samples.WAVELENGTH * 1e-9, rtol=FLOAT_RTOL)
    name = "S" if form == "jaz" else "column 2"
    np.testing.assert_allclose(found.columns[name], samples.COUNTS, rtol=FLOAT_RTOL)
    assert found.integration_time == 0.6
    assert found.averages == 2
    assert found.date == datetime(2013, 2, 13, 9, 53, 48)
    assert found.dark_corrected is False
    assert found.linearised is False


def test_pixels_may_stand_in_falling_order_between_the_fences(tmp_path):
    lines = samples.spectrum("spectrasuite").decode("latin-1").splitlines()
    first, last = (place for place, line in enumerate(lines) if line.startswith(">>>>>"))
    lines[first + 1 : last] = reversed(lines[first + 1 : last])
    path = tmp_path / "a.txt"
    path.write_text("\n".join(lines) + "\n")
    found = read_spectrum(path)
    np.testing.assert_allclose(found.wavelength, samples.WAVELENGTH * 1e-9, rtol=FLOAT_RTOL)
    np.testing.assert_allclose(found.columns["column 2"], samples.COUNTS, rtol=FLOAT_RTOL)


@pytest.mark.parametrize("form", samples.FORMS)
def test_a_folder_of_spectra_is_one_dataset(tmp_path, form):
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), form)
    assert check_test(place) == []
    test = contracts.check(read_test(place), "test")
    assert test.counts.shape == (3, 24)
    np.testing.assert_allclose(test.spectrum_time, [0.5, 1.5, 2.5])
    np.testing.assert_allclose(test.counts[2], samples.COUNTS + 20, rtol=FLOAT_RTOL)
    np.testing.assert_allclose(test.background_counts, samples.DARK, rtol=FLOAT_RTOL)
    assert test.attrs["spectrometer_integration_time"] == 0.6


def test_wavelengths_in_air_become_those_in_vacuum(tmp_path):
    from plasmapyro.refraction import air_wavelength, vacuum_wavelength

    air, vacuum = np.array(list(PAIRS_NM)), np.array(list(PAIRS_NM.values()))
    np.testing.assert_allclose(vacuum_wavelength(air * 1e-9), vacuum * 1e-9, atol=1e-13)
    np.testing.assert_allclose(air_wavelength(vacuum_wavelength(air * 1e-9)), air * 1e-9, rtol=1e-12)
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), "spectrasuite")
    np.testing.assert_allclose(
        read_test(place).wavelength, vacuum_wavelength(samples.WAVELENGTH * 1e-9), rtol=FLOAT_RTOL
    )
    stated = samples.SPECTRA + "  wavelengths: vacuum\n"
    place = samples.spectra(samples.folder(tmp_path / "v", stated), "spectrasuite")
    np.testing.assert_allclose(read_test(place).wavelength, samples.WAVELENGTH * 1e-9, rtol=FLOAT_RTOL)


def test_dates_of_the_files_give_the_middle_of_the_exposures(tmp_path):
    parts = samples.SPECTRA.replace(
        "{from: order, first: 0.5, period: 1.0}", '{from: date, zero: "2013-02-13 09:53:30"}'
    )
    place = samples.spectra(samples.folder(tmp_path / "t", parts), "oceanview")
    np.testing.assert_allclose(
        read_test(place).spectrum_time, [9.4, 11.4, 13.4]
    )  # 2 x 0.6 s end at 10, 12, 14


def test_clipped_samples_are_lost_and_others_are_not():
    counts = np.stack([samples.COUNTS * 10] * 2)
    counts[1, 5:12] = 64000.0
    counts[1, 20] = 64000.0
    lost = clipped(counts)
    assert not lost[0].any()
    assert lost[1].sum() == 8
    flat = np.full(100, 3000.0)
    assert not clipped(flat).any()


def test_clipped_samples_become_nan_in_the_dataset(tmp_path):
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), "spectrasuite comma")
    counts = samples.COUNTS.copy()
    counts[8:15] = 64000.0
    (place / "spectrometer" / "frame_0001.txt").write_bytes(samples.spectrum("spectrasuite comma", counts))
    test = read_test(place)
    assert np.isnan(test.counts.values[1, 8:15]).all()
    assert np.isnan(test.counts.values).sum() == 7
    assert test.attrs["clipped_samples"] == 7


REFUSED = {
    "fewer pixels": (
        lambda b: b.replace(b"756.96\t2360.00\r\n", b""),
        "holds 23 pixels, its header promises 24",
    ),
    "half a row": (lambda b: b.replace(b"\t2360.00", b""), "1 values where 2 are expected"),
    "a letter in a number": (lambda b: b.replace(b"2360.00", b"236O.00"), "'236O.00' is not a number"),
    "two decimal signs": (lambda b: b.replace(b"2360.00", b"2360,00"), "mixed"),
    "falling wavelengths": (lambda b: b.replace(b"756.96", b"746.96"), "do not rise"),
    "not a spectrum": (lambda b: b"some words\n", "no line '>>>>>Begin"),
    "binary": (lambda b: b[:900] + b"\0\1\2" + b[900:], "binary"),
    "nothing": (lambda b: b"", "is empty"),
    "another exposure": (lambda b: b.replace(b"600000", b"500000"), "integration time 0.5, but 0.6"),
    "other wavelengths": (lambda b: b.replace(b"756.96", b"756.97"), "other wavelengths"),
    "no exposure": (lambda b: b.replace(b"600000", b"0"), "is not a number > 0"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_damaged_spectrum_is_refused_by_name(tmp_path, case):
    change, words = REFUSED[case]
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), "spectrasuite")
    path = place / "spectrometer" / "frame_0001.txt"
    sound = samples.spectrum("spectrasuite")
    assert change(sound) != sound
    path.write_bytes(change(sound))
    (message,) = check_test(place)
    assert "frame_0001.txt" in message
    assert words in message
    with pytest.raises(contracts.ContractError):
        read_test(place)


def test_all_bad_files_are_named_at_once(tmp_path):
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA + "  colum: S\n"), "jaz", number=4)
    (place / "spectrometer" / "frame_0003.txt").write_bytes(b"x")
    (place / "spectrometer" / "frame_0002.txt").write_bytes(b"")
    assert "did you mean 'column'" in "".join(check_test(place))
    samples.folder(place, samples.SPECTRA)
    assert len(check_test(place)) == 2


def test_settings_in_the_headers_must_not_contradict_the_description(tmp_path):
    parts = samples.SPECTRA
    place = samples.spectra(samples.folder(tmp_path / "t", parts), "spectrasuite")
    text = (place / "test.yaml").read_text()
    (place / "test.yaml").write_text(
        text.replace("  spectrometer_fwhm", "  spectrometer_integration_time: 0.5\n  spectrometer_fwhm")
    )
    (message,) = check_test(place)
    assert "is 0.5, the headers of the spectra say 0.6" in message


def test_a_pipe_is_not_waited_for(tmp_path):
    import os

    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), "jaz")
    os.mkfifo(place / "spectrometer" / "frame_0009.txt")
    (message,) = check_test(place)
    assert "not a plain file" in message


def test_hidden_files_are_none_of_the_instrument(tmp_path):
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), "oceanview")
    for name in ("._frame_0000.txt", ".frame_0001.txt.swp", ".hidden.csv"):
        (place / "spectrometer" / name).write_bytes(b"\x00\x05\x16\x07")
    assert check_test(place) == []
    assert read_test(place).sizes["spectrum_time"] == 3


def test_a_spliced_spectrum_may_hold_more_than_its_header_promises(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(samples.spectrum("oceanview").replace(b"Spectrum: 24", b"Spectrum: 20"))
    assert read_spectrum(path).wavelength.size == 24


def test_a_plain_spectrum_without_a_last_line_end_is_refused_only_if_digits_may_be_lost(tmp_path):
    """Series that a script wrote without it were all 'cut off'."""
    path = tmp_path / "spectrum.txt"
    whole = "\n".join(f"{750 + 0.5 * i:.3f}\t{2000 + i:.2f}" for i in range(50))
    path.write_text(whole)
    assert read_spectrum(path).wavelength.size == 50
    path.write_text(whole[:-1])
    with pytest.raises(Refusal, match="line 50: the last line has no end and may be cut off; copy "):
        read_spectrum(path)
    path.write_text("\n".join(f"{10 * (750 + 0.5 * i):.3f}\t{2000 + i:.2f}" for i in range(50)) + "\n")
    with pytest.raises(Refusal, match="nor columns of wavelength and signal; export it in nm .*Angstrom"):
        read_spectrum(path)


def test_a_table_in_another_unit_is_told_the_key_that_says_so(tmp_path):
    """The key stood in no page, and 'check the unit' named none."""
    described = "spectrometer:\n  file: s.csv\n  quantity: spectral_radiance\n  unit: W/m2/sr/nm\n"
    table = "time,0.750,0.751,0.752\n0.5,1,2,3\n1.5,4,5,6\n"
    (message,) = check_test(samples.folder(tmp_path / "t", described, s__csv=table))
    assert "0.75 to 0.752 nm" in message and "`wavelength_unit: um`, `Angstrom`" in message
