"""Bounds on infrared bands that the radiation lacks: light of 1 % of a molecule, for docs/radiation.md.

    python benchmarks/missing_bands.py

Thin light of a column is its number times S(T) times Planck's law. The strength of a band that raises mode k
by d_k grows with temperature as that of harmonic modes does:

    S(T) = S_0 [1 - exp(-sum d_k x_k)] prod 1/[1 - exp(-x_k)]^d_k,   x_k = c2 w_k / T

(D. K. Edwards, Adv. Heat Transfer 12 (1976) 115; Q. Zou and P. Varanasi, J. Quant. Spectrosc. Radiat.
Transfer 75 (2002) 63). Of OH all upper levels with their probabilities.
"""

import numpy as np
from scipy.constants import Avogadro, Boltzmann, c, h

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.radiation.planck import blackbody_radiance

PRESSURE, SHARE, PATH = 5e3, 0.01, 0.01  # [Pa], [1], [m]
KELVIN = (3000.0, 4000.0, 5000.0, 6000.0)
EDWARDS, GRAM = "Edwards (1976)", 1e4 / Avogadro  # cm-1/(g m-2) into cm-1/(molecules cm-2), times g/mol
BANDS = (  # name, centre [cm-1], modes [cm-1] with their rise, strength [cm] of a cold molecule, source
    ("CO 2.35 um", 4260.0, {2143.0: 2}, 7.53e-20, "Zou and Varanasi (2002)"),
    ("H2O 1.38 um", 7250.0, {3652.0: 1, 3756.0: 1}, 2.5 * 18.0 * GRAM, EDWARDS),
    ("H2O 1.87 um", 5350.0, {1595.0: 1, 3756.0: 1}, 3.0 * 18.0 * GRAM, EDWARDS),
    ("CO2 2.0 um", 5200.0, {1351.0: 2, 2396.0: 1}, 0.066 * 44.0 * GRAM, EDWARDS),
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


def main():
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


if __name__ == "__main__":
    main()
