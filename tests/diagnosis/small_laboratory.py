"""What the invented experiment of these tests is: powers, slit, heating and cooling of the sample."""

import numpy as np

SLIT_FWHM = 0.75e-9
POWERS = {"60kW": 60e3, "80kW": 80e3, "100kW": 100e3}
OFF = 120.0  # s


def temperature_of(time):
    rise = 350 + 1150 * -np.expm1(-np.maximum(time, 0) / 12.0)
    top = 350 + 1150 * -np.expm1(-OFF / 12.0)
    # radiative cooling: T^-3 grows linearly
    fall = (top**-3.0 + 3e-12 * 4 * np.maximum(time - OFF, 0)) ** (-1 / 3)
    return np.where(time < OFF, rise, fall)
