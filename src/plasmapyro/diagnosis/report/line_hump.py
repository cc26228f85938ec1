"""Lines of the gas against its smooth light: where the measured point lies, and where explanations lead."""

import numpy as np

from plasmapyro.diagnosis.fit.model import POWER_SIGMA
from plasmapyro.diagnosis.gas.templates import BANDS_OF
from plasmapyro.diagnosis.report.findings import pulls
from plasmapyro.diagnosis.report.show import LINE_REACH

LINE = 777.6e-9  # [m] of O I
HUMP = (985e-9, 1030e-9)  # [m] of N2 first positive
# Shares of what a matt surface returns: the track bends within the first hundredths.
MATT = np.array([0.0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0])
BINS = np.arange(745e-9, 1031e-9, 5e-9)  # [m] edges in which explanations are compared with a spectrum
SHAPE_SIGMA = 0.01  # [1] of the light of a bin, besides strengths and power
LEAST = 1e-3  # [1] of the light of a bin: a gas without it has no logarithm there
FINER = 8  # steps between two amplitudes of a track
UNKNOWN_ERROR = 0.05  # [1] of a line or hump that no group of the library holds
FREE_NUMBER = 2.0  # of chi-squared: what an explanation's amplitude must gain (H. Akaike, IEEE TAC 19, 1974)
# Tracks that are one cause: more power is a hotter core; a mirror shows the sight line itself and adds more
# of the same light, as a longer path would.
ONE_CAUSE = {"core": "P_eff", "refl": "path", "refl_diffuse": "refl"}


def line_against_hump(findings):
    """Entry of the measured point and the tracks of the explanations; None without a plasma."""
    if not findings.model.plasma:
        return None
    model, solution, found = findings.model, findings.base.solution, findings.comparison
    spectrum = model.library.base * found.ratio

    def error(word):
        return min((one.error for one in found.systems if word in one.name), default=UNKNOWN_ERROR)

    moved = any(row["finding"] for row in pulls(model, solution) if row["id"].startswith("gain_"))
    tracks = explanations(model.library, model.emittance)
    return line_hump(model.library, (spectrum, (error("O I 77"), error(BANDS_OF))), tracks, calibration=moved)


def factors(library, spectrum):
    """Line and hump (2,) of a spectrum over those of the library."""
    axis = library.wavelength
    line = np.abs(axis - LINE) < LINE_REACH
    hump = (axis > HUMP[0]) & (axis < HUMP[1])
    return tuple(float(spectrum[part].sum() / library.base[part].sum()) for part in (line, hump))


def line_hump(library, strengths, explanations, calibration=False):
    """Line and hump of the gas against the simulation: the measured point and where explanations lead.

    `strengths`: spectrum (K,) and relative errors of line and hump, what the fit makes of the gas;
    `explanations`: id -> (name, amplitudes, function amplitude -> spectrum (K,)); `calibration`: whether the
    throughput of an instrument left its prior: surface and gas err alike.
    """
    spectrum, errors = strengths
    line, hump = factors(library, spectrum)
    tracks = []
    for identity, (name, amplitudes, change) in explanations.items():
        points = [factors(library, change(amplitude)) for amplitude in amplitudes]
        tracks.append(
            {
                "id": identity,
                "name": name,
                "amplitude": [float(a) for a in amplitudes],
                "line": [p[0] for p in points],
                "hump": [p[1] for p in points],
            }
        )
    closest = "calibration" if calibration else _closest(library, spectrum, explanations)
    return {
        "measured": {
            "line": line,
            "hump": hump,
            "line_error": abs(line) * errors[0],  # where a gas has no such line, noise may make it negative
            "hump_error": abs(hump) * errors[1],
        },
        "tracks": tracks,
        "closest": closest,
    }


def _closest(library, spectrum, explanations):
    r"""Explanation that leaves least of a spectrum (K,) to the strengths and the power, or 'none'.

    .. math:: \chi^2 = \min_a (y - y_a)^T C^{-1} (y - y_a), \quad
              C = \sum_g \sigma_g^2 f_g f_g^T + \sigma_P^2 p p^T + \sigma^2

    with the logarithms :math:`y` of the light in `BINS` over the simulated one, the share :math:`f_g` of a
    group of lines in them and their change :math:`p` with the power. Line and hump alone leave power and
    path, ripple and excitation close to one another; the other bins tell them apart.
    """
    axis = library.wavelength
    place = np.digitize(axis, BINS) - 1
    inside = (place >= 0) & (place < BINS.size - 1)
    used = np.unique(place[inside])

    def binned(values):
        return np.bincount(place[inside], values[inside], BINS.size - 1)[used]

    base = binned(library.base)

    def logarithm(values):
        return np.log(np.maximum(binned(values) / base, LEAST))

    errors = np.array([binned(mode) for mode in library.strength_modes]) / base
    step = POWER_SIGMA / 2
    power = logarithm(library.power_factor(step) * library.base) - logarithm(
        library.power_factor(-step) * library.base
    )
    rows = np.concatenate([errors, [power]])
    covariance = rows.T @ rows + SHAPE_SIGMA**2 * np.eye(used.size)
    white = np.linalg.inv(np.linalg.cholesky(covariance))
    measured = logarithm(spectrum)
    left = {"none": float(np.sum((white @ measured) ** 2)) - FREE_NUMBER}
    for identity, (_, amplitudes, change) in explanations.items():
        nodes = np.arange(len(amplitudes))
        finer = np.interp(np.linspace(0, nodes[-1], FINER * nodes[-1] + 1), nodes, amplitudes)
        away = np.array([measured - logarithm(change(amplitude)) for amplitude in finer])
        left[identity] = float(np.min(np.sum((away @ white.T) ** 2, axis=1)))
    closest = min(left, key=left.get)
    return ONE_CAUSE.get(closest, closest)


def explanations(library, emittance):
    """Explanations of a line and a hump that differ from the simulation: {id: (name, amplitudes, change)}.

    `change` gives the spectrum for an amplitude; what the library does not hold explains nothing.
    """
    base, addition = library.base, library.addition

    def added(name):
        return lambda a: base + a * (1 - emittance) * addition[name]

    def varied(name):
        return lambda a: base * library.factor(name, a)

    found = {
        "P_eff": (
            "simulated power",
            np.log(np.array([0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.6])),
            lambda a: base * library.power_factor(a),
        )
    }
    if "reflected_specular" in addition:
        mirror = np.linspace(0, 1.5, 6)
        found["refl"] = ("reflected gas light, mirror", mirror, added("reflected_specular"))
        found["refl_diffuse"] = ("reflected gas light, matt", MATT, added("reflected_diffuse"))
    for identity, name, variation, amplitudes in (
        ("T_exc", "excitation of the atoms", "excitation", np.linspace(-0.1, 0.1, 9)),
        ("ripple", "ripple of the torch", "ripple", np.linspace(0, 0.2, 6)),
        ("core", "temperature of the core", "core_temperature", np.linspace(-0.12, 0.12, 9)),
    ):
        if library.varies(variation):
            found[identity] = (name, amplitudes, varied(variation))
    grey = np.linspace(-0.5, 1.0, 7)
    return found | {"path": ("path length or grey calibration", grey, lambda a: base * (1 + a))}
