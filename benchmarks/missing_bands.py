"""Bounds on infrared bands that the radiation lacks: light of 1 % of a molecule, for docs/radiation.md.

    python benchmarks/missing_bands.py [--spectra results/design/gas_spectra.nc]

With the spectra of a run to 2500 nm (docs/radiation.md) bands of InGaAs and extended InGaAs are judged: what
the computed gas adds to the reading, and what these bounds would add, spread evenly over each band.

Thin light of a column is its number times S(T) times Planck's law. The strength of a band that raises mode k
by d_k grows with temperature as that of harmonic modes does:

    S(T) = S_0 [1 - exp(-sum d_k x_k)] prod 1/[1 - exp(-x_k)]^d_k,   x_k = c2 w_k / T

(D. K. Edwards, Adv. Heat Transfer 12 (1976) 115; Q. Zou and P. Varanasi, J. Quant. Spectrosc. Radiat.
Transfer 75 (2002) 63: 7.53e-20 cm for CO; R. A. Toth et al., ibid. 109 (2008) 906: 5.956e-20 cm for all
lines of CO2 from 4300 to 7000 cm-1, that at 2.0 um among them). Of OH all upper
levels with their probabilities.
"""

import argparse

import numpy as np
from scipy.constants import Avogadro, Boltzmann, c, h

from plasmapyro import io
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.radiation.planck import blackbody_radiance

PRESSURE, SHARE, PATH = 5e3, 0.01, 0.01  # [Pa], [1], [m]
KELVIN = (3000.0, 4000.0, 5000.0, 6000.0)
EDWARDS, GRAM = "Edwards (1976)", 1e4 / Avogadro  # cm-1/(g m-2) into cm-1/(molecules cm-2), times g/mol
LIMITS = {  # [nm] between which a band shines
    "CO 2.35 um": (2290, 2500),
    "H2O 1.38 um": (1320, 1500),
    "H2O 1.87 um": (1770, 2000),
    "CO2 2.0 um": (1940, 2080),
    "OH 1.4 to 2.2 um": (1400, 2200),
    "OH 1.0 to 1.5 um": (1000, 1500),
}
INSTRUMENTS = {  # bands [nm]
    "ratio, 0.75-1.1 and 0.95-1.1 um (silicon)": ((750, 1100), (950, 1100)),
    "ratio, 1.28-1.32 and 1.60-1.62 um (InGaAs)": ((1280, 1320), (1602, 1618)),
    "ratio, 1.52 and 1.64 um (InGaAs)": ((1495, 1545), (1615, 1665)),
    "one colour, 1.25-1.28 um (InGaAs)": ((1250, 1280),),
    "one colour, 1.55-1.65 um (InGaAs)": ((1550, 1650),),
    "one colour, 2.1-2.25 um (extended InGaAs)": ((2100, 2250),),
    "one colour, 2.0-2.4 um (extended InGaAs)": ((2000, 2400),),
}
SURFACE, EMITTANCE, SHOWN, GAS = (1000.0, 1500.0), 0.85, "90kW", 4000.0  # [K], [1], condition, [K]
BANDS = (  # name, centre [cm-1], modes [cm-1] with their rise, strength [cm] of a cold molecule, source
    ("CO 2.35 um", 4260.0, {2143.0: 2}, 7.53e-20, "Zou and Varanasi (2002)"),
    ("H2O 1.38 um", 7250.0, {3652.0: 1, 3756.0: 1}, 2.5 * 18.0 * GRAM, EDWARDS),
    ("H2O 1.87 um", 5350.0, {1595.0: 1, 3756.0: 1}, 3.0 * 18.0 * GRAM, EDWARDS),
    ("CO2 2.0 um", 5000.0, {1351.0: 2, 2396.0: 1}, 5.956e-20, "Toth et al. (2008)"),
)
# D. N. Turnbull and R. P. Lowe, Planet. Space Sci. 37 (1989) 723: OH, probabilities [s-1] of v' = 2, 3, ... 9
OH = {2: (15.42, 40.33, 69.77, 99.42, 125.6, 145.1, 154.3, 148.9)}
OH[3] = (0.0, 2.032, 7.191, 15.88, 27.94, 42.91, 59.98, 78.64)
OH_QUANTUM, OH_ANHARMONIC = 3737.8, 84.9  # [cm-1]; Huber and Herzberg (1979)


def of_band(centre, modes, strength, kelvin, column):
    """Light [W m-2 sr-1] of a band of a column [m-2]."""
    x = {SECOND_RADIATION * 100 * quantum / kelvin: rise for quantum, rise in modes.items()}
    growth = -np.expm1(-sum(rise * one for one, rise in x.items()))
    growth /= np.prod([(-np.expm1(-one)) ** rise for one, rise in x.items()])
    wavelength = 0.01 / centre
    return column * 0.01 * strength * growth * blackbody_radiance(wavelength, kelvin) * wavelength**2


def of_hydroxyl(fall, kelvin, column):
    """Light [W m-2 sr-1] of the bands of OH whose v falls by so many, of a column [m-2]."""
    level = np.arange(10)
    energy = 100 * level * (OH_QUANTUM - OH_ANHARMONIC * (level + 1))
    share = np.exp(-SECOND_RADIATION * energy / kelvin)
    share /= share.sum()
    photon = h * c * (energy - energy[np.maximum(level - fall, 0)])[2:]
    return column / (4 * np.pi) * float(share[2:] @ (np.array(OH[fall]) * photon))


def too_high(wavelength, added, kelvin, edges):
    """How much too high [K] a surface of some temperature is read with light (B,) added to its own."""
    shift, places = [], []
    for low, high in edges:
        inside = (wavelength > low * 1e-9) & (wavelength < high * 1e-9)
        weight = wavelength * inside  # photons
        own = EMITTANCE * blackbody_radiance(wavelength, kelvin)
        shift.append(np.log1p((weight @ added) / (weight @ own)))
        places.append(weight @ (wavelength * own) / (weight @ own))
    colour = SECOND_RADIATION / np.array(places)
    inverse = shift[0] / colour[0] if len(edges) == 1 else (shift[0] - shift[1]) / (colour[0] - colour[1])
    return kelvin / (1 - kelvin * inverse) - kelvin


def judged(path, rows):
    """Print what gas, and the bounds at `GAS` of missing bands (name, [light]) in `rows`, add to readings."""
    spectra = io.read(path, "gas_spectra")
    wavelength = spectra.wavelength.values
    gas = spectra.binned_radiance.sel(condition=SHOWN, state="nominal").sum("component").values
    columns = {"computed gas": gas}
    for name, light, _ in rows:
        low, high = (1e-9 * end for end in LIMITS[name])
        flat = (wavelength > low) & (wavelength < high)
        columns[name] = flat * light[KELVIN.index(GAS)] / (high - low)
    head = [f"{kelvin:g} K" for kelvin in SURFACE]
    print("| instrument | " + " | ".join(columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for name, edges in INSTRUMENTS.items():
        cells = [
            ", ".join(f"{too_high(wavelength, added, kelvin, edges):+.3g}" for kelvin in SURFACE)
            for added in columns.values()
        ]
        print(f"| {name} | " + " | ".join(cells) + " |")
    print(f"(K too high at surfaces of {' and '.join(head)}, emittance {EMITTANCE}, {SHOWN}; gas ignored)")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spectra", metavar="FILE.nc", help="judge instruments with the gas of a run")
    options = parser.parse_args()
    print("| band | " + " | ".join(f"{kelvin:g} K" for kelvin in KELVIN) + " | strength |")
    print("|---" * (len(KELVIN) + 2) + "|")
    columns = [SHARE * PRESSURE / (Boltzmann * kelvin) * PATH for kelvin in KELVIN]
    both = list(zip(KELVIN, columns, strict=True))
    rows = [(name, [of_band(*band, *one) for one in both], source) for name, *band, source in BANDS]
    for fall, place in ((2, "1.4 to 2.2 um"), (3, "1.0 to 1.5 um")):
        light = [of_hydroxyl(fall, *one) for one in both]
        rows.append((f"OH {place}", light, "Turnbull and Lowe (1989)"))
    for name, light, source in rows:
        print(f"| {name} | " + " | ".join(f"{one:.2g}" for one in light) + f" | {source} |")
    if options.spectra:
        judged(options.spectra, rows)


if __name__ == "__main__":
    main()
