"""Colours that mean the same in every figure and on every page."""

WIDE, NARROW, SPECTRUM = "#1f5fa8", "#c0392b", "#5b7f3a"  # bands of the pyrometer, spectrometer
PAPER, BASE, EXTENDED = "#8a8a8a", "#1f5fa8", "#c2571a"  # whose temperature
PHASES = ("#eef2f7", "#fff6e5", "#fdeeee", "#eef7ee", "#f2eefa", "#f0f0f0")  # of a test
MISFIT = ("#e9967f", "#f2bda8", "#f8ddcf", "#fcf0e4", "#eef6ee")  # worst first
STATUS = {  # of a temperature: given in colours, refused in greys, faults of the record in red
    "valid": "#1f5fa8",
    "calibration_extrapolated": "#56a3d9",
    "gas_dominated": "#e0a030",
    "below_range": "#8d99a6",
    "above_range": "#5b6673",
    "no_signal": "#c3cad2",
    "not_injected": "#e6e9ed",
    "missing": "#2b2b2b",
    "straddling": "#a58bc4",
    "saturated": "#c0392b",
    "contradicted": "#7b1e3a",
}
