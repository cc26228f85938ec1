"""The catalogue: everything that the diagnosis knows by name."""

from itertools import product

from plasmapyro.diagnosis import terms_gas as gas
from plasmapyro.diagnosis import terms_instrument as device
from plasmapyro.diagnosis import terms_path as path
from plasmapyro.diagnosis import terms_surface as surface
from plasmapyro.diagnosis.effect import BOTH, PHASES, Effect

ALL, HOT = PHASES, ("heating", "steady", "cooling")
BURNING, EXPOSED = PHASES[:4], ("cold", "heating", "steady")
PYROMETER, SPECTROMETER = ("pyrometer",), ("spectrometer",)
INF = float("inf")
PAPER = "Fagnani et al."
KNOWN = "Z. M. Zhang, B. K. Tsai & G. Machin, Radiometric Temperature Measurements (2010)"


def grid(**values):
    """Every combination of some numbers, as a tuple of dictionaries."""
    return tuple(dict(zip(values, combination, strict=True)) for combination in product(*values.values()))


def _list():
    lamp_check = "a lamp seen through the window before and after the test"
    source_check = "the blackbody calibration repeated after the test, through the window"
    e = Effect
    return (
        # the surface
        e("eps_slope", "emittance that varies with wavelength", "spectral emittance", "surface", "slope",
          "um-1",
          0.3, (-1.5, 1.5), BOTH, HOT, "spectral emittance of the sample at temperature", KNOWN,
          degenerate_with=("edge2", "phi"), light=surface.slope),
        e("eps_T", "emittance that follows the temperature", "emittance with temperature", "surface",
          "change",
          "1", 0.05, (-0.6, 0.6), BOTH, HOT, "emittance measured at two temperatures", KNOWN,
          degenerate_with=("grad",), light=surface.with_temperature),
        e("eps_ox", "emittance that changes for good (oxidation, loss of coating)", "emittance in time",
          "surface", "change", "1", 0.1, (-0.8, 0.8), BOTH, HOT, "emittance measured after the test", KNOWN,
          grid(time_constant=(10.0, 40.0, 150.0)), {"time_constant": (3.0, 400.0)}, ("eps_T",),
          light=surface.oxidation),
        e("refl", "light of the gas reflected by the surface", "reflected gas", "surface",
          "share of a mirror",
          "1", 1.0, (0.0, 3.0), BOTH, EXPOSED, "a sample of low emittance; a spectrum before injection",
          PAPER,
          grid(diffuse=(0.0, 0.1)), {"diffuse": (0.0, 1.0)}, ("P_eff", "T_exc"), light=surface.reflection),
        e("torchglow", "glow of hot walls reflected by the surface", "reflected glow", "surface",
          "view factor",
          "1", 0.004, (0.0, 0.2), BOTH, ("cold", "heating", "cooling"), "a cold sample in view of the torch",
          KNOWN, grid(temperature=(850.0, 1200.0, 1550.0), decay=(8.0, 40.0)),
          {"temperature": (700.0, 1800.0), "decay": (2.0, 100.0)}, ("off2",), light=surface.torch_glow),
        e("grad", "temperature gradient over the spot", "spot", "surface", "standard deviation", "K", 60.0,
          (0.0, 250.0), BOTH, HOT, "an infrared camera; a second spot size", KNOWN,
          degenerate_with=("eps_T", "clock"), quadratic=True, light=surface.gradient),
        e("edge_p", "spot of the pyrometer beyond the sample", "spot", "surface", "share of the spot", "1",
          0.08,
          (0.0, 0.6), PYROMETER, HOT, "an image of the spot; an alignment laser", KNOWN,
          grid(ratio=(0.72, 0.86), lag=(3.0, 12.0)), {"ratio": (0.5, 0.98), "lag": (0.5, 30.0)}, ("edge_s",),
          light=surface.cover_pyrometer),
        e("edge_s", "spot of the spectrometer beyond the sample", "spot", "surface", "share of the spot", "1",
          0.08, (0.0, 0.6), SPECTROMETER, HOT, "an image of the spot; an alignment laser", KNOWN,
          grid(ratio=(0.72, 0.86), lag=(3.0, 12.0)), {"ratio": (0.5, 0.98), "lag": (0.5, 30.0)}, ("edge_p",),
          light=surface.cover_spectrometer),
        # the gas
        e("P_eff", "power of the plasma, temperature of its core", "strength of the plasma", "gas",
          "relative change of the gas temperature", "1", 0.06, (-0.16, 0.16), BOTH, BURNING,
          "enthalpy of the jet; spectra at several powers", PAPER, degenerate_with=("ripple", "T_exc"),
          light=gas.varied("core_temperature")),
        e("ripple", "ripple of the torch", "strength of the plasma", "gas", "amplitude of the temperature",
          "1",
          0.08, (0.0, 0.25), BOTH, BURNING, "a photodiode of 2 kHz or more", PAPER,
          degenerate_with=("P_eff",),
          quadratic=True, light=gas.varied("ripple")),
        e("T_exc", "excitation of the atoms away from equilibrium", "excitation of the gas", "gas",
          "relative change of the excitation temperature", "1", 0.05, (-0.12, 0.12), BOTH, BURNING,
          "lines of O I from several levels", PAPER, degenerate_with=("P_eff", "refl"),
          light=gas.varied("excitation")),
        e("T_vib", "vibration of N2 away from equilibrium", "vibration of the gas", "gas",
          "relative change of the vibrational temperature", "1", 0.2, (-0.4, 0.5), BOTH, BURNING,
          "bands of N2 first positive at high resolution", PAPER, light=gas.varied("vibration")),
        e("selfabs", "lines that absorb themselves", "optical depth", "gas", "depth of the strongest line",
          "1",
          0.4, (0.0, 3.0), BOTH, BURNING, "O I 777 against 844 nm at several powers", PAPER,
          light=gas.varied("optical_depth")),
        e("contin", "more continuum of the gas", "continuum", "gas", "share of the light", "0.01", 5.0,
          (-30.0, 100.0), BOTH, BURNING, "spectra between the lines, calibrated absolutely", PAPER,
          light=gas.continuum),
        e("gas_drift", "brightness of the gas that drifts", "gas in time", "gas", "change until the end", "1",
          0.1, (-0.7, 0.7), BOTH, EXPOSED, "power, pressure and mass flow recorded", PAPER, light=gas.drift,
          shape_bounds={f"hat_{place}": (-gas.LARGEST_WAVE, gas.LARGEST_WAVE) for place in range(gas.WAVES)}),
        e("bl", "boundary layer warmed by the wall", "gas near the wall", "gas", "share of the model", "1",
          1.0,
          (0.0, 50.0), BOTH, EXPOSED, "spectra in the wall layer", PAPER, light=gas.warm_wall),
        e("afterglow", "gas that shines after the end", "gas near the wall", "gas", "share", "1", 0.2, (0.0,
          3.0),
          BOTH, ("cooling",), "fast signals after the end", PAPER, grid(decay=(0.5, 2.0)),
          {"decay": (0.1, 10.0)}, light=gas.afterglow),
        e("particles", "hot grains in the sight line", "grains", "gas", "share of a black body", "1", 3e-4,
          (0.0, 0.05), BOTH, EXPOSED, "fast signals: single grains flash", KNOWN,
          grid(temperature=(2000.0, 2400.0)), {"temperature": (1900.0, 2700.0)}, ("scat",),
          light=gas.particles),
        e("NaK", "sodium and potassium", "foreign matter", "gas", "tenth of O I 777 at 1600 K", "0.1", 1.0,
          (0.0, 500.0), BOTH, EXPOSED, "chemistry of the sample", KNOWN, grid(growth=(6.0, 12.0, 20.0)),
          {"growth": (3.0, 30.0)}, light=gas.released("Na I", "K I")),
        e("CaII", "ionised calcium", "foreign matter", "gas", "tenth of O I 777 at 1600 K", "0.1", 1.0,
          (0.0, 500.0), BOTH, EXPOSED, "chemistry of the sample", KNOWN, grid(growth=(6.0, 12.0, 20.0)),
          {"growth": (3.0, 30.0)}, light=gas.released("Ca II")),
        e("CN", "cyanogen from the oxidation of carbon", "foreign matter", "gas", "hundredth of the light",
          "0.01",
          1.0, (0.0, 200.0), BOTH, EXPOSED, "the violet system of CN at 388 nm", KNOWN,
          grid(growth=(4.0, 10.0), decay=(150.0, 600.0)), {"growth": (1.0, 20.0), "decay": (20.0, 2000.0)},
          light=gas.cyanogen),
        e("Cu", "copper of the coil or electrodes", "foreign matter", "gas", "tenth of O I 777", "0.1", 1.0,
          (0.0, 500.0), BOTH, BURNING, "a spectrum without a sample", KNOWN, light=gas.foreign("Cu I")),
        e("Ar", "argon in the jet", "foreign matter", "gas", "tenth of O I 777", "0.1", 1.0, (0.0, 500.0),
          BOTH,
          BURNING, "a spectrum without a sample; purge the feed lines", KNOWN, light=gas.foreign("Ar I")),
        # the path
        e("winD", "deposit on window D", "throughput of the pyrometer", "path", "loss at the end", "1", 0.07,
          (-0.2, 0.8), PYROMETER, HOT, lamp_check, KNOWN, degenerate_with=("winD_sl",), light=path.window_d),
        e("winE", "deposit on window E", "throughput of the spectrometer", "path", "loss at the end", "1",
          0.07,
          (-0.2, 0.8), SPECTROMETER, HOT, lamp_check, KNOWN, degenerate_with=("winE_sl", "eps_ox"),
          light=path.window_e),
        e("winD_sl", "blue deposit on window D", "throughput of the pyrometer", "path", "loss at 950 nm", "1",
          0.05, (-0.1, 0.6), PYROMETER, HOT, lamp_check, KNOWN, grid(exponent=(1.0, 2.5, 4.0)),
          {"exponent": (0.7, 4.2)}, ("winD",), light=path.window_d_sloped),
        e("winE_sl", "blue deposit on window E", "throughput of the spectrometer", "path", "loss at 950 nm",
          "1",
          0.05, (-0.1, 0.6), SPECTROMETER, HOT, lamp_check, KNOWN, grid(exponent=(1.0, 2.5, 4.0)),
          {"exponent": (0.7, 4.2)}, ("winE",), light=path.window_e_sloped),
        e("h2o", "water vapour in the optical path", "air", "path", "absorption in the strongest bin", "1",
          0.02,
          (-0.2, 0.3), BOTH, ALL, "purge the path with dry gas", KNOWN, light=path.absorber("water_vapour")),
        e("o2a", "oxygen in the optical path", "air", "path", "absorption in the strongest bin", "1", 0.02,
          (-0.2, 0.3), BOTH, ALL, "length of the path against that of the calibration", KNOWN,
          light=path.absorber("oxygen_a_band")),
        e("scat", "scattering by grains", "grains", "path", "loss at 950 nm", "1", 0.01, (0.0, 0.3), BOTH,
          EXPOSED,
          "a lamp through the seeded jet", KNOWN, degenerate_with=("particles",), light=path.scattering),
        # the optics
        e("edge1", "edges of the wide band", "responses of the pyrometer", "optics", "shift", "nm", 6.0,
          (-25.0, 25.0), PYROMETER, HOT, source_check, KNOWN, degenerate_with=("phi", "eps_slope"),
          light=device.shifted_response(0)),
        e("edge2", "edges of the narrow band", "responses of the pyrometer", "optics", "shift", "nm", 6.0,
          (-25.0, 25.0), PYROMETER, HOT, source_check, KNOWN, degenerate_with=("phi", "eps_slope",
          "resp_long"),
          light=device.shifted_response(1)),
        e("resp_long", "long-wave tail of the responses", "responses of the pyrometer", "optics",
          "change of the tail", "1", 0.1, (-0.6, 0.8), PYROMETER, HOT, "temperature of the detector recorded",
          KNOWN, degenerate_with=("edge2", "phi"), light=device.response_tail),
        e("wshift", "wavelength scale of the spectrometer", "wavelength scale", "optics", "shift", "nm", 0.3,
          (-3.0, 3.0), SPECTROMETER, ALL, "a line lamp", KNOWN, light=device.wavelength_shift),
        e("lsf", "slit function of the spectrometer", "slit function", "optics", "further standard deviation",
          "nm", 0.2, (0.0, 1.0), SPECTROMETER, BURNING, "a line lamp", KNOWN, quadratic=True,
          light=device.wider_slit),
        e("second", "second order of the grating", "stray light", "optics", "share", "1", 0.5, (0.0, 10.0),
          SPECTROMETER, BURNING, "a long-pass filter of 550 nm", KNOWN, light=gas.second_order),
        # the detectors
        e("phi", "error of the sensitivity ratio", "calibration ratio", "detector", "relative error", "1",
          0.015,
          (-0.2, 0.2), PYROMETER, HOT, source_check, PAPER, degenerate_with=("edge2", "eps_slope"),
          output=device.ratio),
        e("off1", "offset of the wide band", "offsets of the pyrometer", "detector", "in units of the gas",
          "1",
          0.05, (-0.6, 0.6), PYROMETER, ALL, "dark signal before and after", KNOWN, output=device.offset(0)),
        e("off2", "offset of the narrow band", "offsets of the pyrometer", "detector", "in units of the gas",
          "1",
          0.05, (-0.6, 0.6), PYROMETER, ALL, "dark signal before and after", KNOWN, output=device.offset(1)),
        e("off_s", "dark counts of the spectrometer", "dark counts", "detector", "in units of the gas", "1",
          0.05,
          (-0.6, 0.6), SPECTROMETER, ALL, "a dark spectrum after the test", KNOWN, output=device.dark_counts),
        e("stray", "stray light in the spectrometer", "stray light", "detector", "share", "1", 0.005, (0.0,
          0.2),
          SPECTROMETER, HOT, "a long-pass filter", KNOWN, output=device.stray),
        e("nonlin_p", "nonlinear pyrometer", "linearity", "detector", "at the largest signal", "1", 0.02,
          (-0.3, 0.3), PYROMETER, HOT, "two apertures or a neutral filter", KNOWN,
          output=device.compressed_signal),
        e("nonlin_s", "nonlinear spectrometer", "linearity", "detector", "at the largest count", "1", 0.02,
          (-0.3, 0.3), SPECTROMETER, HOT, "one lamp at several exposure times", KNOWN,
          output=device.compressed_counts),
        e("clock", "clocks that disagree", "clock", "clock", "pyrometer early", "s", 0.4, (-4.0, 4.0),
          PYROMETER,
          ("heating", "cooling"), "one flash of light seen by both", KNOWN, degenerate_with=("grad",),
          clock=device.pyrometer_late),
    )  # fmt: skip


EFFECTS = {effect.id: effect for effect in _list()}
