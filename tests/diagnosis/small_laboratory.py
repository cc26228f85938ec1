"""What the invented experiment of these tests is: powers, slit, heating and cooling of the sample."""

import numpy as np

SLIT_FWHM = 0.75e-9
POWERS = {"60kW": 60e3, "80kW": 80e3, "100kW": 100e3}
OFF = 120.0  # s
FIT = (900.0, 1700.0)  # K, of the calibration points


def temperature_of(time, off=OFF, rise_time=12.0, height=1150.0, drop=0.0):
    """Temperature [K]; `drop` [K s-1/2] at the end, as of a body that conducts badly, fading in 0.5 s."""
    rise = 350 + height * -np.expm1(-np.maximum(time, 0) / rise_time)
    top = 350 + height * -np.expm1(-off / rise_time)
    # radiative cooling: T^-3 grows linearly
    after = np.maximum(time - off, 0)
    fall = (top**-3.0 + 3e-12 * 4 * after) ** (-1 / 3) - drop * np.sqrt(after / (1 + 2 * after))
    return np.where(time < off, rise, fall)


def flicker_of(time, size, random):
    """Brightness (t,) of a gas that flickers as 1/f between 0.01 and 5 Hz, standard deviation `size`."""
    axis = np.arange(-100.0, 300.0, 0.1)
    frequency = np.fft.rfftfreq(axis.size, 0.1)
    noise = random.normal(size=(2, frequency.size)) * np.where(frequency > 0.01, 1, 0)
    value = np.fft.irfft((noise[0] + 1j * noise[1]) / np.sqrt(np.maximum(frequency, 0.01)), axis.size)
    return 1 + size * np.interp(time, axis, value / value.std())


H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
LINES = (
    (777.4, 60.0, 6.0),
    (844.6, 20.0, 6.2),
    (868.0, 25.0, 7.0),
    (926.6, 9.0, 6.5),
)  # nm, strength, exponent


def black_body(wavelength, temperature):
    return 2 * H * C**2 / wavelength**5 / np.expm1(H * C / (wavelength * K * np.asarray(temperature, float)))


def gas_components(axis, power):
    """Atomic lines and a molecular hump (C, K) [W m-2 sr-1 m-1]."""
    ratio = power / 80e3
    atoms = np.zeros((2, axis.size))
    for place, strength, exponent in LINES:
        row = 1 if place == 868.0 else 0
        sigma = SLIT_FWHM / 2.3548
        atoms[row] += strength * ratio**exponent * np.exp(-(((axis - place * 1e-9) / sigma) ** 2) / 2)
    hump = 12.0 * ratio * (1 + 0.5 * np.sin(axis / 7e-9)) * np.exp(-(((axis - 1e-6) / 1.5e-7) ** 2))
    return 1e6 * np.array([atoms[0], atoms[1], hump])


def error_modes(axis, strength):
    """Variables of a radiance file: strengths (a fourth: a continuum), 5 % of each line and of the hump."""
    rows, systems, causes = [], [], []

    def add(row, system, cause):
        rows.append(row)
        systems.append(system)
        causes.append(cause)

    names = ("O I", "N I", "N2 1P", "e-neutral free-free")[: max(len(strength), 3)]
    for system, size in zip(names, strength, strict=True):
        add(np.full(axis.size, max(size, 0.08)), system, "strength")
    for place, *_ in LINES:
        near = np.abs(axis - place * 1e-9) < 3e-9
        add(np.where(near, 0.05, 0.0), "N I" if place == 868.0 else "O I", "multiplet")
    for length in (3e-9, 25e-9):
        centres = np.arange(axis[0], axis[-1] + length, length)
        bumps = np.exp(-0.5 * ((axis - centres[:, None]) / (0.7 * length)) ** 2)
        for row in 0.05 * bumps / np.sqrt(np.sum(bumps**2, axis=0)):
            add(row, "N2 1P", "rotation")
    return {
        "error_share": (("error_mode", "wavelength_slit"), np.array(rows)),
        "error_system": ("error_mode", np.array(systems, dtype=object)),
        "error_cause": ("error_mode", np.array(causes, dtype=object)),
    }
