"""Colours that mean the same in every figure and on every page."""

WIDE, NARROW, SPECTRUM = "#1f5fa8", "#c0392b", "#5b7f3a"  # bands of the pyrometer, spectrometer
PAPER, BASE, EXTENDED = "#8a8a8a", "#1f5fa8", "#c2571a"  # whose temperature
PHASES = ("#eef2f7", "#fff6e5", "#fdeeee", "#eef7ee", "#f2eefa", "#f0f0f0")  # of a test
MISFIT = ("#e9967f", "#f2bda8", "#f8ddcf", "#fcf0e4", "#eef6ee")  # worst first
