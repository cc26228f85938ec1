"""Where atoms and molecules radiate: the twin's own short lists, wavelengths in vacuum [nm].

Relative strengths are degeneracy times transition probability unless a list says otherwise.
The numbers are in `lines.csv`.
"""

import csv
from pathlib import Path


def _numbers(name):
    """Rows of a list."""
    return tuple(
        tuple(float(word) if "." in word else int(word) for word in row[1:] if word)
        for row in ROWS
        if row[0] == name
    )


with Path(__file__).with_name("lines.csv").open(encoding="utf-8", newline="") as _table:
    ROWS = list(csv.reader(_table))

# Strong multiplets between 720 and 1155 nm: range, upper level [cm-1].
# Kramida et al., NIST Atomic Spectra Database, https://doi.org/10.18434/T4W30F.
NITROGEN, OXYGEN = _numbers("nitrogen"), _numbers("oxygen")
# N2+ Meinel: the band that shines most in a range, by its upper level [cm-1] above the ground state, from the
# constants of K. P. Huber & G. Herzberg, Constants of Diatomic Molecules (1979). Bands are shaded to the red.
MEINEL = _numbers("meinel")
# Lines that absorb themselves first: O I, with relative optical depth (gf times lower population at 6000 K).
OXYGEN_DEPTH = _numbers("oxygen_depth")
# N2 first positive system: (v', wavelength of the origin in air [nm], A [10^3 s-1]). Wavelengths and
# potentials: Laher & Gilmore, J. Phys. Chem. Ref. Data 20, 685 (1991); moment: Laux & Kruger, JQSRT 48.
NITROGEN_BANDS = _numbers("nitrogen_bands")
# Term energy of v' = 0 to 9 of N2 B above X [cm-1]: Laher & Gilmore (1991).
NITROGEN_VIBRATION = tuple(one for (one,) in _numbers("nitrogen_vibration"))
# Impurities: NIST Atomic Spectra Database, as above; of argon also the upper level [cm-1].
SODIUM_POTASSIUM, CALCIUM_ION = _numbers("sodium_potassium"), _numbers("calcium_ion")
COPPER, RUBIDIUM, ARGON = _numbers("copper"), _numbers("rubidium"), _numbers("argon")
# CN red system: (v', head in vacuum [nm], relative strength A q), degraded to the red.
# Brooke et al., Astrophys. J. Suppl. 210, 23 (2014).
CYANOGEN = _numbers("cyanogen")
CYANOGEN_QUANTUM = 1790.0  # [cm-1] of the upper state
# Seen in the second order above 910 nm: places in the first order [nm], relative radiance, width [nm].
# N2+ first negative heads, degraded to the violet: Lofthus & Krupenie, J. Phys. Chem. Ref. Data 6 (1977).
SECOND_ORDER = _numbers("second_order")
# Water vapour: shape of the absorption at low resolution (relative to its maximum at 935 nm), after the
# bands in Rothman et al., JQSRT 277, 107949 (2022) (HITRAN2020).
WATER = _numbers("water")
# O2 A band: band origin, rotational constants of the upper and lower state [cm-1]:
# Krupenie, J. Phys. Chem. Ref. Data 1, 423 (1972).
(OXYGEN_BAND,) = _numbers("oxygen_band")
