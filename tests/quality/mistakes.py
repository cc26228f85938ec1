"""A hundred mistakes that a laboratory makes, each applied to sound data; what they do is in the name.

Every mistake is a function of a folder with `calibration` and `my_test` in it, as in docs/example, that
spoils one of the two. It knows nothing of the rules.
"""

import re
import shutil

import numpy as np
import yaml

from plasmapyro.readers.ocean import read_spectrum

MISTAKES = {}  # name -> function (folder)
SPECTRA = "my_test/spectrometer"


def mistake(function):
    """Register a mistake under the words of its name."""
    MISTAKES[function.__name__.replace("_", " ")] = function
    return function


def family(name, **cases):
    """Register one mistake per case of a function that makes them."""

    def register(make):
        for words, value in cases.items():
            title = name.format(words.replace("_", " "))
            MISTAKES[title] = lambda folder, value=value: make(folder, value)
        return make

    return register


def attributes(folder, **changes):
    """Change attributes of test.yaml; None removes one."""
    path = folder / "my_test/test.yaml"
    described = yaml.safe_load(path.read_text())
    stated = described["attributes"]
    for key, value in changes.items():
        stated[key] = value
        if value is None:
            del stated[key]
    path.write_text(yaml.safe_dump(described, sort_keys=False))


def described(folder, change, name="my_test/test.yaml"):
    """Change a description in place."""
    path = folder / name
    values = yaml.safe_load(path.read_text())
    change(values)
    path.write_text(yaml.safe_dump(values, sort_keys=False))


def table(folder, change, name="my_test/pyrometer.csv"):
    """Change the numbers of a table: rows (n, 3) in, rows out."""
    path = folder / name
    header, *lines = path.read_text().splitlines()
    rows = change(np.array([[float(cell) for cell in line.split(";")] for line in lines]))
    body = "".join(";".join(f"{cell:.10g}" for cell in row) + "\n" for row in rows)
    path.write_text(header + "\n" + body)


def counts(path, change):
    """Change the counts of one spectrum file: (wavelength, counts) -> counts."""
    spectrum = read_spectrum(path)
    (values,) = spectrum.columns.values()
    body = "".join(
        f"{w * 1e9:.3f}\t{c:.3f}\n" for w, c in zip(spectrum.wavelength, change(values), strict=True)
    )
    words = path.read_text()
    path.write_text(
        re.sub(r"(Data<<<<<\n).*?(>>>>>End)", lambda m: m[1] + body + m[2], words, flags=re.DOTALL)
    )


def spectra(folder):
    """Files of the series, in order."""
    return sorted((folder / SPECTRA).iterdir())


def column(rows, number, change, where=slice(None)):
    """Rows with a column changed."""
    rows = rows.copy()
    rows[where, number] = change(rows[where, number])
    return rows


# The pyrometer's log -------------------------------------------------------------------------------


@mistake
def the_same_column_for_both_bands(folder):
    described(folder, lambda v: v["pyrometer"]["columns"].update(signal_narrow={"name": "S1"}))


@mistake
def columns_of_the_bands_exchanged_in_the_description(folder):
    described(
        folder,
        lambda v: v["pyrometer"]["columns"].update(signal_narrow={"name": "S1"}, signal_wide={"name": "S2"}),
    )


@mistake
def cables_of_the_bands_exchanged(folder):
    table(folder, lambda rows: rows[:, [0, 2, 1]])


@family("gain of the wide band {}", ten_per_cent_up=1.1, ten_per_cent_down=0.9, range_switch_of_ten=10.0)
def gain_of_wide(folder, factor):
    table(folder, lambda rows: column(rows, 1, lambda s: s * factor))


@family("gain of the narrow band {}", ten_per_cent_up=1.1, ten_per_cent_down=0.9, range_switch_of_ten=0.1)
def gain_of_narrow(folder, factor):
    table(folder, lambda rows: column(rows, 2, lambda s: s * factor))


@family(
    "gain of one band {} from 25 s on", five_per_cent_down=0.95, five_per_cent_up=1.05, ten_per_cent_up=1.1
)
def gain_step(folder, factor):
    table(folder, lambda rows: column(rows, 1, lambda s: s * factor, rows[:, 0] >= 25))


@mistake
def both_amplifiers_switched_by_ten_at_25_s(folder):
    table(
        folder,
        lambda r: column(column(r, 1, lambda s: s / 10, r[:, 0] >= 25), 2, lambda s: s / 10, r[:, 0] >= 25),
    )


@family("one band in another unit than its header says: {}", uA=1e-3, A=1e-9, mA=1e-6)
def one_unit(folder, factor):
    table(folder, lambda rows: column(rows, 1, lambda s: s * factor))


@family("both bands in another unit than their header says: {}", uA=1e-3, pA=1e3)
def both_units(folder, factor):
    table(folder, lambda rows: column(column(rows, 1, lambda s: s * factor), 2, lambda s: s * factor))


@mistake
def volts_of_the_amplifier_without_a_scale(folder):
    def volts(rows):
        return column(column(rows, 1, lambda s: s * 1e-9 * 1e6), 2, lambda s: s * 1e-9 * 1e6)

    table(folder, volts)
    path = folder / "my_test/pyrometer.csv"
    path.write_text(path.read_text().replace("[nA]", "[A]"))


@family("amplifier clipped at {} of its highest signal", half=0.5, four_fifths=0.8)
def clipped(folder, share):
    table(folder, lambda rows: column(rows, 1, lambda s: np.minimum(s, share * s.max())))


@mistake
def both_amplifiers_clipped(folder):
    def change(rows):
        return column(
            column(rows, 1, lambda s: np.minimum(s, 0.6 * s.max())), 2, lambda s: np.minimum(s, 0.6 * s.max())
        )

    table(folder, change)


@family("logger stuck from {} s on", ten=(10, 99), thirty=(30, 99), twenty_to_twenty_five=(20, 25))
def stuck(folder, span):
    def change(rows):
        held = (rows[:, 0] >= span[0]) & (rows[:, 0] < span[1])
        rows[held, 1:] = rows[held, 1:][0]
        return rows

    table(folder, change)


@mistake
def one_channel_stuck_from_30_s_on(folder):
    table(folder, lambda r: column(r, 2, lambda s: np.full_like(s, s[0]), r[:, 0] >= 30))


@mistake
def inverted_amplifier(folder):
    table(folder, lambda rows: column(column(rows, 1, np.negative), 2, np.negative))


@family("offset of the wide band {} of its highest signal", minus_a_tenth=-0.1, plus_a_tenth=0.1)
def offset(folder, share):
    table(folder, lambda rows: column(rows, 1, lambda s: s + share * s.max()))


@mistake
def pick_up_of_the_arc_in_the_reference_window(folder):
    def change(rows):
        places = np.flatnonzero((rows[:, 0] > 1) & (rows[:, 0] < 4))[::5]
        rows[places, 2] *= 8
        return rows

    table(folder, change)


@family("clock of the pyrometer {}", two_seconds_late=2.0, two_seconds_early=-2.0, five_seconds_late=5.0)
def clock_of_pyrometer(folder, shift):
    table(folder, lambda rows: column(rows, 0, lambda t: t + shift))


@mistake
def zero_forgotten(folder):
    table(folder, lambda rows: column(rows, 0, lambda t: t + 10776))


@family("time of the pyrometer in {} under a header in s", ms=1e3, min=1 / 60)
def unit_of_time(folder, factor):
    table(folder, lambda rows: column(rows, 0, lambda t: t * factor))


@mistake
def first_file_of_a_split_log_forgotten(folder):
    table(folder, lambda rows: rows[rows[:, 0] >= 12])


@mistake
def last_file_of_a_split_log_forgotten(folder):
    table(folder, lambda rows: rows[rows[:, 0] < 40])


@mistake
def a_hole_of_twelve_seconds_in_the_log(folder):
    table(folder, lambda rows: rows[(rows[:, 0] < 20) | (rows[:, 0] > 32)])


@mistake
def log_pasted_twice(folder):
    table(folder, lambda rows: np.concatenate([rows, rows]))


@mistake
def log_sorted_by_the_signal(folder):
    table(folder, lambda rows: rows[np.argsort(rows[:, 1])])


@mistake
def a_decimal_sign_lost_in_one_band(folder):
    table(folder, lambda r: column(r, 1, lambda s: s * 1e4, (r[:, 0] >= 30) & (r[:, 0] < 30.2)))


@mistake
def signal_of_another_test(folder):
    table(folder, lambda r: column(r, 2, lambda s: s[::-1].copy()))


@mistake
def window_before_the_pyrometer_fogged_from_20_s_on(folder):
    table(
        folder,
        lambda r: column(column(r, 1, lambda s: s * 0.8, r[:, 0] >= 20), 2, lambda s: s * 0.8, r[:, 0] >= 20),
    )


@mistake
def plasma_not_yet_burning_in_the_reference_window(folder):
    table(
        folder,
        lambda r: column(
            column(r, 1, lambda s: s * 1e-5, r[:, 0] < 5.5), 2, lambda s: s * 1e-5, r[:, 0] < 5.5
        ),
    )


# Facts of the test ---------------------------------------------------------------------------------


@family(
    "plasma_off_time {}",
    five_seconds_late=55.0,
    five_seconds_early=45.0,
    of_another_test=30.0,
    in_minutes=0.83,
)
def off(folder, value):
    attributes(folder, plasma_off_time=value)


@family("emittance {}", in_per_cent=80, of_the_ratio=1.8, as_one_minus_it=0.2, of_another_sample=0.3)
def emittance(folder, value):
    attributes(folder, emittance=value)


@family(
    "reference window {}",
    over_the_first_light=[0.0, 10.0],
    over_the_hot_surface=[20.0, 25.0],
    reversed=[5.0, 0.0],
)
def reference_window(folder, value):
    attributes(folder, reference_window=value)


@family("spectrometer_fwhm {}", in_nm=4.0, in_um=4e-3, in_pm=4e-12)
def fwhm(folder, value):
    attributes(folder, spectrometer_fwhm=value)


@mistake
def emittance_slope_turned_over(folder):
    attributes(folder, emittance_slope=1 / 0.85)


@family("emittance slope {} that is not the surface's", a_tenth_up=1.1, a_tenth_down=0.9)
def slope(folder, value):
    attributes(folder, emittance_slope=value)


@mistake
def integration_time_of_the_pyrometer_in_ms(folder):
    attributes(folder, pyrometer_integration_time=10.0)


@mistake
def transmittance_of_the_window_in_per_cent(folder):
    attributes(folder, window_transmittance_pyrometer=90)


@mistake
def transmittance_of_a_filter_for_that_of_the_window(folder):
    attributes(folder, window_transmittance_spectrometer=0.09)


@mistake
def injection_time_of_another_test(folder):
    attributes(folder, injection_time=20.0, reference_window=[20.0, 25.0])


@mistake
def origin_left_out(folder):
    attributes(folder, origin=None)


# Spectra and their dark ----------------------------------------------------------------------------


@mistake
def files_numbered_without_zeros(folder):
    for index, path in enumerate(spectra(folder), 1):
        path.rename(path.with_name(f"s{index}.txt"))


@family("one spectrum of the series lost: the {}", second=1, fifth=4, eighth=7)
def lost(folder, index):
    spectra(folder)[index].unlink()


@mistake
def first_spectrum_of_the_series_lost(folder):
    spectra(folder)[0].unlink()


@mistake
def last_spectra_of_the_series_lost(folder):
    for path in spectra(folder)[-4:]:
        path.unlink()


@mistake
def two_spectra_exchanged(folder):
    third, tenth = (spectra(folder)[i] for i in (3, 10))
    words = third.read_text(), tenth.read_text()
    third.write_text(words[1])
    tenth.write_text(words[0])


@mistake
def one_spectrum_copied_over_the_next(folder):
    shutil.copy(spectra(folder)[5], spectra(folder)[6])


@mistake
def series_in_reversed_order(folder):
    paths = spectra(folder)
    words = [path.read_text() for path in paths]
    for path, text in zip(paths, reversed(words), strict=True):
        path.write_text(text)


@mistake
def a_lamp_file_among_the_series(folder):
    shutil.copy(folder / "calibration/short.txt", folder / SPECTRA / "lamp_005.txt")
    described(folder, lambda v: None)
    for path in [folder / SPECTRA / "lamp_005.txt"]:
        path.write_text(path.read_text().replace("100000", "500000"))


@mistake
def the_dark_left_in_the_series(folder):
    shutil.copy(folder / "my_test/dark.txt", folder / SPECTRA / "dark.txt")


@family("period of the spectra {}", five_seconds=5.0, three_seconds=3.0, in_ms=4000.0)
def period(folder, value):
    described(folder, lambda v: v["spectrometer"]["time"].update(period=value))


@family("first spectrum {}", two_seconds_late=4.0, two_seconds_early=0.0, one_period_late=6.0)
def first(folder, value):
    described(folder, lambda v: v["spectrometer"]["time"].update(first=value))


@mistake
def dark_of_zeros(folder):
    counts(folder / "my_test/dark.txt", lambda c: 0 * c)


@family("a light file as dark: {}", of_the_plasma=0, of_the_warm_surface=3, of_the_hot_surface=9)
def light_as_dark(folder, index):
    shutil.copy(spectra(folder)[index], folder / "my_test/dark.txt")


@mistake
def dark_of_another_integration_time(folder):
    shutil.copy(folder / "calibration/short_dark.txt", folder / "my_test/dark.txt")


@family("dark of other settings under the same header, {}", half=0.5, double=2.0)
def other_dark(folder, factor):
    counts(folder / "my_test/dark.txt", lambda c: 2000 + (c - 2000) * factor)


@mistake
def dark_left_out(folder):
    described(folder, lambda v: v["spectrometer"].pop("background"))


@family("counts declared as radiance in {}", W_m2_sr_nm="W/m2/sr/nm", uW_cm2_sr_nm="uW/cm2/sr/nm")
def as_radiance(folder, unit):
    described(
        folder, lambda v: v["spectrometer"].update(quantity="spectral_radiance", unit=unit, column="column 2")
    )


@mistake
def wavelengths_in_vacuum_declared_by_mistake_for_the_test_only(folder):
    described(folder, lambda v: v["spectrometer"].update(wavelengths="vacuum"))


@mistake
def spectra_of_another_exposure_under_the_same_header(folder):
    for path in spectra(folder):
        counts(path, lambda c: 2000 + (c - 2000) / 5)


@mistake
def spectra_saturated_without_a_plateau_of_five(folder):
    for path in spectra(folder):
        counts(path, lambda c: np.where(c > 0.7 * 15000, 0.7 * 15000 + (np.arange(c.size) % 3), c))


@mistake
def boxcar_over_thirty_pixels(folder):
    for path in spectra(folder):
        counts(path, lambda c: np.convolve(np.pad(c, 15, mode="edge"), np.ones(31) / 31, mode="valid"))


@mistake
def fibre_bent_from_25_s_on(folder):
    for path in spectra(folder)[6:]:
        counts(path, lambda c: 2000 + (c - 2000) * 0.5)


# The calibration -----------------------------------------------------------------------------------


@mistake
def points_in_celsius_read_as_kelvin(folder):
    described(
        folder,
        lambda v: v["pyrometer"]["columns"]["source_temperature"].update(unit="K"),
        "calibration/calibration.yaml",
    )


@mistake
def points_in_kelvin_read_as_celsius(folder):
    table(folder, lambda rows: column(rows, 0, lambda t: t + 273.15), "calibration/points.csv")


@mistake
def black_body_of_the_spectrometer_in_celsius(folder):
    described(
        folder,
        lambda v: v["spectrometer"]["source"].update(temperature_k=1700 - 273.15),
        "calibration/calibration.yaml",
    )


@mistake
def bands_exchanged_in_the_calibration(folder):
    table(folder, lambda rows: rows[:, [0, 2, 1]], "calibration/points.csv")


@family(
    "one calibration point mistyped, {}",
    signal=(4, 1, 1.5),
    temperature=(4, 0, 1.09),
    digits_exchanged=(6, 2, 0.82),
)
def point(folder, change):
    row, number, factor = change
    table(folder, lambda rows: column(rows, number, lambda s: s * factor, row), "calibration/points.csv")


@mistake
def hottest_points_clipped(folder):
    table(folder, lambda r: column(r, 1, lambda s: np.minimum(s, 0.4 * s.max())), "calibration/points.csv")


@family("gain of one band in the calibration {}", ten_per_cent_up=1.1, switched_half_way=None)
def gain_in_calibration(folder, factor):
    def change(rows):
        return column(rows, 1, lambda s: s * (factor or 1.15), slice(None) if factor else slice(4, None))

    table(folder, change, "calibration/points.csv")


@mistake
def filter_of_the_source_forgotten(folder):
    described(folder, lambda v: v["spectrometer"].pop("filter_transmittance"), "calibration/calibration.yaml")


@mistake
def filter_in_per_cent(folder):
    described(
        folder, lambda v: v["spectrometer"].update(filter_transmittance=50), "calibration/calibration.yaml"
    )


@mistake
def light_and_dark_of_the_source_exchanged(folder):
    def change(values):
        for one in values["spectrometer"]["exposures"]:
            one["light"], one["dark"] = one["dark"], one["light"]

    described(folder, change, "calibration/calibration.yaml")


@mistake
def darks_of_the_source_exchanged(folder):
    def change(values):
        pair = values["spectrometer"]["exposures"]
        pair[0]["dark"], pair[1]["dark"] = pair[1]["dark"], pair[0]["dark"]

    described(folder, change, "calibration/calibration.yaml")


@mistake
def a_spectrum_of_the_test_as_source(folder):
    text = spectra(folder)[9].read_text().replace("500000", "200000")
    (folder / "calibration/long.txt").write_text(text)


@mistake
def integration_time_in_the_headers_of_one_exposure_wrong(folder):
    for name in ("long", "long_dark"):
        path = folder / f"calibration/{name}.txt"
        path.write_text(path.read_text().replace("200000", "400000"))


@mistake
def linearity_of_another_detector(folder):
    described(
        folder,
        lambda v: v["spectrometer"].update(linearity_coefficients=[1.0, -8e-5]),
        "calibration/calibration.yaml",
    )


@mistake
def emittance_of_the_black_body_in_per_cent(folder):
    described(
        folder, lambda v: v["spectrometer"]["source"].update(emittance=99.5), "calibration/calibration.yaml"
    )


@mistake
def a_pixel_range_masked_that_is_lit(folder):
    described(
        folder,
        lambda v: v["spectrometer"].update(masked_pixels=list(range(100, 150))),
        "calibration/calibration.yaml",
    )


# Exports, spreadsheets and folders -----------------------------------------------------------------


def lines(folder, change, name="my_test/pyrometer.csv"):
    """Change a text file line by line: list in, list out."""
    path = folder / name
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")


def both(rows, change, where=slice(None)):
    """Rows with both signals changed alike."""
    return column(column(rows, 1, change, where), 2, change, where)


@family("missing samples of one band written as {}", minus_9999=-9999.0, nought=0.0, plus_9999999=9.999999e9)
def sentinel(folder, value):
    table(folder, lambda rows: column(rows, 2, lambda s: 0 * s + value, np.arange(len(rows)) % 10 == 7))


@family(
    "a cell says {}",
    OVER="OVER",
    VALUE="#VALUE!",
    a_time="0:00:12",
    inf="inf",
    thousands="1,234.5",
    E="1,2E+3",
)
def odd_cell(folder, words):
    def change(rows):
        cells = rows[120].split(";")
        return [*rows[:120], ";".join([cells[0], words, cells[2]]), *rows[121:]]

    lines(folder, change)


@mistake
def decimal_commas_in_the_second_half_of_the_log(folder):
    lines(folder, lambda rows: rows[:130] + [row.replace(".", ",") for row in rows[130:]])


@mistake
def decimal_commas_stripped_by_a_spreadsheet(folder):
    lines(folder, lambda rows: [rows[0]] + [row.replace(".", "") for row in rows[1:]])


@mistake
def header_and_rows_of_a_second_log_pasted_below(folder):
    lines(folder, lambda rows: rows + rows)


@mistake
def a_row_of_units_below_the_header(folder):
    lines(folder, lambda rows: ["Time;S1;S2", "s;nA;nA", *rows[1:]])


@mistake
def merged_cells_of_time(folder):
    lines(
        folder,
        lambda rows: (
            rows[:1] + [r if i % 4 == 0 else ";" + r.split(";", 1)[1] for i, r in enumerate(rows[1:])]
        ),
    )


@mistake
def utf_16_without_its_mark(folder):
    path = folder / "my_test/pyrometer.csv"
    path.write_bytes(path.read_text().encode("utf-16-le"))


@family(
    "time of the log {}",
    in_days_of_a_spreadsheet=1 / 86400,
    of_another_sampling_rate=0.8,
    in_half_seconds=2.0,
)
def wrong_time(folder, factor):
    table(folder, lambda rows: column(rows, 0, lambda t: t * factor))


@mistake
def lost_rows_closed_up_and_the_time_made_anew(folder):
    def change(rows):
        kept = rows[(rows[:, 0] < 20) | (rows[:, 0] >= 25)]
        kept[:, 0] = rows[: len(kept), 0]
        return kept

    table(folder, change)


@family("one band pasted {} lower", one_row=1, four_rows=4, twenty_rows=20)
def pasted_lower(folder, count):
    table(folder, lambda rows: column(rows, 2, lambda s: np.r_[s[:1].repeat(count), s[:-count]]))


@mistake
def one_column_sorted_alone(folder):
    table(folder, lambda rows: column(rows, 2, np.sort))


@mistake
def ratio_in_the_place_of_a_band(folder):
    table(folder, lambda rows: column(rows, 2, lambda s: rows[:, 1] / s))


@mistake
def temperatures_in_the_place_of_signals(folder):
    table(folder, lambda rows: both(rows, lambda s: 700 + 90 * np.log(s / s.min())))


@mistake
def peak_picker_left_on(folder):
    def hold(s):
        return np.array([s[max(i - 20, 0) : i + 1].max() for i in range(s.size)])

    table(folder, lambda rows: both(rows, hold))


@family("response time of the pyrometer {}", two_seconds=2.0, five_seconds=5.0)
def slow(folder, tau):
    def follow(s):
        out, step = s.copy(), 1 - np.exp(-0.25 / tau)
        for i in range(1, s.size):
            out[i] = out[i - 1] + step * (s[i] - out[i - 1])
        return out

    table(folder, lambda rows: both(rows, follow))


@mistake
def moving_average_of_ten_seconds(folder):
    def smooth(s):
        return np.convolve(np.pad(s, 20, mode="edge"), np.ones(41) / 41, mode="valid")

    table(folder, lambda rows: both(rows, smooth))


@family("zero of one amplifier drifts by {} of its highest signal", a_twentieth=0.05, a_tenth=0.1)
def drift(folder, share):
    table(folder, lambda r: column(r, 2, lambda s: s + share * s.max() * np.linspace(0, 1, s.size)))


@mistake
def converter_wraps_around(folder):
    table(folder, lambda r: column(r, 1, lambda s: np.where(s > 0.5 * s.max(), s - s.max(), s)))


@mistake
def hum_of_the_mains_in_one_band(folder):
    table(folder, lambda r: column(r, 2, lambda s: s + 0.05 * s.max() * np.sin(2.1 * np.arange(s.size))))


@mistake
def soft_saturation_of_one_band(folder):
    table(folder, lambda r: column(r, 1, lambda s: 0.8 * s.max() * np.tanh(s / (0.8 * s.max()))))


@mistake
def all_of_the_log_one_sample(folder):
    table(folder, lambda rows: both(rows, lambda s: 0 * s + s[100]))


@mistake
def few_digits(folder):
    table(folder, lambda rows: both(rows, lambda s: np.round(s / s.max() * 40) / 40 * s.max()))


@mistake
def reference_window_in_ms(folder):
    attributes(folder, reference_window=[0.0, 5000.0])


@mistake
def plasma_off_time_counted_from_the_begin_of_the_record(folder):
    attributes(folder, plasma_off_time=54.0)


@mistake
def sign_of_the_zero_turned_over(folder):
    described(folder, lambda v: v["pyrometer"].update(zero=-4.0))


# More of spectra -----------------------------------------------------------------------------------


@mistake
def spectra_of_two_tests_in_one_folder(folder):
    for number, path in enumerate(spectra(folder)):
        shutil.copy(path, path.with_name(f"spectrum_{number + 15:03d}.txt"))


@mistake
def every_other_spectrum_of_another_test(folder):
    paths = spectra(folder)
    for path, other in list(zip(paths[1::2], paths[3::2], strict=False)):
        counts(path, lambda c, other=other: np.array(list(read_spectrum(other).columns.values())[0]) + 0 * c)


@mistake
def spectra_in_the_order_of_their_modification(folder):
    paths = spectra(folder)
    words = [path.read_text() for path in paths]
    order = np.random.default_rng(4).permutation(len(paths))
    for path, index in zip(paths, order, strict=True):
        path.write_text(words[index])


@mistake
def a_copy_of_a_file_left_in_the_folder(folder):
    path = spectra(folder)[5]
    shutil.copy(path, path.with_name("spectrum_005 (1).txt"))


@family("integration time of the spectra {}", in_ms_in_a_field_of_us="500", ten_times_too_long="5000000")
def integration(folder, words):
    for path in [*spectra(folder), folder / "my_test/dark.txt"]:
        path.write_text(path.read_text().replace("500000", words))


@mistake
def dark_taken_off_by_the_program_as_well(folder):
    dark = list(read_spectrum(folder / "my_test/dark.txt").columns.values())[0]
    for path in spectra(folder):
        counts(path, lambda c: c - dark)


@mistake
def room_light_in_the_dark(folder):
    counts(folder / "my_test/dark.txt", lambda c: c + 200 * np.exp(-(np.linspace(-1, 1, c.size) ** 2)))


@mistake
def ten_scans_summed(folder):
    for path in spectra(folder):
        counts(path, lambda c: 10 * c)


@family("dead pixels of spectra written as {}", minus_9999=-9999.0, nought=0.0)
def dead(folder, value):
    for path in spectra(folder):
        counts(path, lambda c: np.where(np.arange(c.size) % 12 == 5, value, c))


@mistake
def a_filter_before_the_test_that_the_calibration_lacked(folder):
    edge = 1 / (1 + np.exp(-(np.linspace(750, 1030, 150) - 850) / 30))
    for path in spectra(folder):
        counts(path, lambda c: 2000 + (c - 2000) * edge)


@mistake
def gain_of_the_detector_drifts_by_a_fifth_over_the_pixels(folder):
    for path in spectra(folder):
        counts(path, lambda c: 2000 + (c - 2000) * np.linspace(1.0, 1.2, c.size))


def shifted(path, change):
    """Change the wavelengths of a spectrum file."""
    head, body, tail = re.match(r"(.*Data<<<<<\n)(.*?)(>>>>>End.*)", path.read_text(), re.DOTALL).groups()
    rows = [row.split() for row in body.splitlines()]
    path.write_text(head + "".join(f"{change(float(w)):.3f}\t{c}\n" for w, c in rows) + tail)


@mistake
def wavelengths_of_another_grating_in_the_test(folder):
    for path in [*spectra(folder), folder / "my_test/dark.txt"]:
        shifted(path, lambda w: 750 + 1.5 * (w - 750))


@mistake
def wavelengths_of_another_grating_in_all_files(folder):
    for path in [*folder.glob("*/*.txt"), *spectra(folder)]:
        shifted(path, lambda w: 750 + 0.8 * (w - 750))


# More of the calibration ---------------------------------------------------------------------------


@mistake
def points_in_fahrenheit(folder):
    table(folder, lambda rows: column(rows, 0, lambda t: t * 1.8 + 32), "calibration/points.csv")


@mistake
def first_points_read_before_the_source_was_warm(folder):
    table(folder, lambda r: both(r, lambda s: 0.85 * s, slice(0, 3)), "calibration/points.csv")


@mistake
def temperatures_and_signals_of_the_points_in_opposite_order(folder):
    table(folder, lambda rows: column(rows, 0, lambda t: t[::-1].copy()), "calibration/points.csv")


@mistake
def light_of_the_source_saturated(folder):
    counts(folder / "calibration/long.txt", lambda c: np.minimum(c, 0.5 * c.max() + np.arange(c.size) % 3))


@family("black body of the spectrometer {}", fifty_kelvin_too_low=1650, in_fahrenheit=2600)
def black_body(folder, value):
    described(
        folder,
        lambda v: v["spectrometer"]["source"].update(temperature_k=value),
        "calibration/calibration.yaml",
    )


@mistake
def sensitivity_of_another_pyrometer(folder):
    table(
        folder, lambda r: column(r, 1, lambda s: s * np.linspace(1.0, 1.1, s.size)), "calibration/points.csv"
    )
