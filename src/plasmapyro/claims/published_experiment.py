"""The published experiment: the power its errors imply, and what makes a weaker plasma look stronger."""

import numpy as np

from plasmapyro.diagnosis.report.line_hump import explanations, factors
from plasmapyro.instrument.pyrometer import blackbody_signal, invert_ratio, signal_ratio
from plasmapyro.radiation.bandsignal import band_signal, respond, responsivities

THRESHOLDS = ((1350.0, 0.01), (1120.0, 0.10), (1600.0, 0.002))
"""Surface temperature [K] and relative error of the reading there: Fagnani et al., sec. 5.2. ASSUME: the
steady state, whose temperature the paper shows in a figure only, is read at 1600 K."""
COMPARED = (80e3, 90e3)  # [W] simulations that the reference spectrum resembles, sec. 5.3
EFFICIENCY = (56e3, 64e3)  # [W] 35 to 40 % of 160 kW, sec. 4.1
TRIED = 60  # amplitudes of each explanation
CURVE = np.arange(400.0, 6001.0, 5.0)  # [K] of the ratio curve


class Reader:
    """What a pyrometer without correction reads of a grey surface behind a gas."""

    def __init__(self, response, emittance, sensitivity_ratio):
        self.wavelength = response["wavelength"].values
        self.bands = responsivities(response)
        self.emittance = emittance
        self.scale = np.array([sensitivity_ratio, 1.0])
        self.curve = self._surface(CURVE)
        self.ratio = self.curve[0] / self.curve[1]

    def _surface(self, temperature):
        rows = [blackbody_signal(temperature, self.wavelength, band) for band in self.bands]
        return np.array(rows) * self.scale[:, None]

    def error(self, axis, spectrum, temperature):
        """Relative error (T_app - T)/T at surface temperatures (...) behind a gas (K,), by eqs. 4 to 7."""
        temperature = np.atleast_1d(temperature)
        weights = [respond(axis, self.wavelength, band) for band in self.bands]
        gas = np.array([band_signal(axis, weight, spectrum) for weight in weights])
        signals = self.emittance * self._surface(temperature) + (gas * self.scale)[:, None]
        reading, _ = invert_ratio(signal_ratio(*signals), CURVE, self.ratio)
        return reading / temperature - 1

    def published(self, axis, spectrum):
        """Absolute errors (3,) at the temperatures of the `THRESHOLDS` behind a gas (K,)."""
        return np.abs(self.error(axis, spectrum, [temperature for temperature, _ in THRESHOLDS]))


def _at_power(library, power):
    """Light of the gas (K,) at another power [W]."""
    return library.base * library.power_factor(np.log(power / library.power))


def implied_powers(library, reader):
    """Power (3,) [W] that gives each of the `THRESHOLDS`, NaN outside those simulated."""
    powers = np.exp(np.linspace(library.log_power[0], library.log_power[-1], 200))
    whole = np.array([reader.published(library.wavelength, _at_power(library, p)) for p in powers])
    found = []
    for (_, error), errors in zip(THRESHOLDS, whole.T, strict=True):
        good = np.isfinite(errors) & (errors > 0)
        inside = good.any() and errors[good].min() <= error <= errors[good].max()
        at = np.interp(np.log(error), np.log(errors[good]), np.log(powers[good])) if inside else np.nan
        found.append(np.exp(at))
    return np.array(found)


def explain(library, reader, emittance):
    """What each explanation must amount to so that a weaker plasma gives the published errors.

    `library`: of the power that the efficiency implies. One dict each: id, name, amplitude, whether it is the
    largest tried, errors (3,), misfit (root mean square of the logarithms of the errors over the published
    ones), line and hump (factors of the light of the gas), those that the reference spectrum wants under
    'needed'.
    """
    rows = []
    needed = np.array([factors(library, _at_power(library, power)) for power in COMPARED])
    wanted = np.array([error for _, error in THRESHOLDS])
    for identity, (name, amplitudes, change) in explanations(library, emittance).items():
        tried = np.linspace(amplitudes[0], amplitudes[-1], TRIED)
        results = []
        for amplitude in tried:
            spectrum = change(amplitude)
            errors = reader.published(library.wavelength, spectrum)
            misfit = np.sqrt(np.mean(np.log(errors / wanted) ** 2)) if np.isfinite(errors).all() else np.inf
            results.append((misfit, amplitude, errors, spectrum))
        misfit, amplitude, errors, spectrum = min(results, key=lambda row: row[0])
        line, hump = factors(library, spectrum)
        rows.append(
            {
                "id": identity,
                "name": name,
                "amplitude": float(amplitude),
                "at_limit": bool(amplitude in (tried[0], tried[-1])),
                "errors": [float(e) for e in errors],
                "misfit": float(misfit),
                "line": line,
                "hump": hump,
                "needed": needed.tolist(),
            }
        )
    return rows


AMPLITUDES = {  # explanation -> what its amplitude means
    "P_eff": lambda a: f"{100 * np.expm1(a):+.0f} %",
    "core": lambda a: f"{100 * a:+.1f} %",
    "refl_diffuse": lambda a: f"{a:.2g} of what a matt surface returns",
    "refl": lambda a: f"{a:.2g} of what a mirror returns",
    "ripple": lambda a: f"{100 * a:.0f} %",
    "T_exc": lambda a: f"{100 * a:+.0f} %",
    "path": lambda a: f"x {1 + a:.2g}",
}
POORLY = 0.3  # misfit above which an explanation is said not to be enough


def as_text(library, reader):
    """The worked example as Markdown: implied powers, and what each explanation must amount to."""
    lines = ["| published | simulated power that gives it |", "|---|---|"]
    for (temperature, error), power in zip(THRESHOLDS, implied_powers(library, reader), strict=True):
        found = f"{power / 1e3:.1f} kW" if np.isfinite(power) else "outside those simulated"
        lines.append(f"| the reading is {100 * error:g} % off at {temperature:g} K | {found} |")
    lines.append(f"| efficiency 35 to 40 % | {EFFICIENCY[0] / 1e3:.0f} to {EFFICIENCY[1] / 1e3:.0f} kW |")
    compared = " and ".join(f"{power / 1e3:.0f}" for power in COMPARED)
    lines += [f"| reference spectrum resembles the simulations at | {compared} kW |", ""]
    rows = sorted(explain(library, reader, reader.emittance), key=lambda row: row["misfit"])
    lines += [
        "| explanation | amplitude that fits the errors best | errors it gives | line | hump |",
        "|---|---|---|---|---|",
    ]
    for row in rows:
        amplitude = AMPLITUDES[row["id"]](row["amplitude"])
        amplitude += ", the largest tried" if row["at_limit"] else ""
        amplitude += ", not enough" if row["misfit"] > POORLY else ""
        errors = ", ".join(f"{100 * error:.3g}" for error in row["errors"])
        lines.append(f"| {row['name']} | {amplitude} | {errors} % | {row['line']:.1f} | {row['hump']:.1f} |")
    (line_low, hump_low), (line_high, hump_high) = rows[0]["needed"]
    lines += [
        "",
        f"Wanted by the reference spectrum: line {line_low:.1f} to {line_high:.1f}, "
        f"hump {hump_low:.1f} to {hump_high:.1f}.",
        "",
    ]
    return "\n".join(lines)
