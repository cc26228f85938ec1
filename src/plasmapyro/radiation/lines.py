"""What a radiating system is to the engine: a list of lines with their levels and width coefficients."""

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from plasmapyro.checks import non_negative, positive
from plasmapyro.constants import LIGHT_SPEED, PLANCK

WIDTH_REFERENCE_TEMPERATURE = 1e4  # [K], of the Stark and van der Waals coefficients below
VAN_DER_WAALS_EXPONENT = 0.3  # [1], mean speed to the power 3/5
BAND = 100  # v' counts so many times in the number of a band
LEVEL_STEP = 10.0  # [m-1] energies of one vibrational level agree to this
ENERGY_CLOSURE = 1e-3  # [1], relative; energies and wavenumber come from rounded level tables

_NUMBERS = {
    "wavenumber": "m-1",
    "upper_energy": "m-1",
    "lower_energy": "m-1",
    "upper_degeneracy": "1",
    "lower_degeneracy": "1",
    "einstein_a": "s-1",
    "natural_hwhm": "m-1",
    "stark_hwhm": "m2",
    "stark_exponent": "1",
    "van_der_waals_hwhm": "m2",
    "resonance_hwhm": "m2",
    "upper_rotation": "m-1",
    "lower_rotation": "m-1",
    "family": "1",
    "strength_uncertainty": "1",
}
_SIGNED = ("stark_exponent", "upper_rotation", "lower_rotation")
_POSITIVE = ("wavenumber", "upper_degeneracy", "lower_degeneracy")


@dataclass(frozen=True)
class LineList:
    r"""Lines of one radiating system, atomic or molecular; every number is an array over the lines.

    Half widths at half maximum of the Lorentz part add up as

    .. math:: \gamma = \gamma_{nat} + w_S n_e (T/T_0)^{m} + w_W n_0 (T/T_0)^{0.3} + w_R n_s,
              \qquad T_0 = 10^4\ \mathrm{K},

    with electron density :math:`n_e`, density of all neutral particles :math:`n_0` and of the
    species itself :math:`n_s`.

    ValueError: shapes that differ, NaN, a value out of range, or energies that do not differ by the
    wavenumber.

    Parameters
    ----------
    component : name of the radiating system in the results ('N I', 'O I', 'N2 1P', ...)
    species : gas species that radiates ('N', 'O', 'N2', ...); its number density and partition function count
    wavenumber : (L,) [m-1]
        In vacuum, > 0.
    upper_energy, lower_energy : (L,) [m-1]
        Of the levels, above the lowest level of the species (the zero of its partition function).
    upper_degeneracy, lower_degeneracy : (L,) [1]
        Statistical weights, > 0. For molecules the rotational level's weight times its nuclear-spin
        weight divided by the total spin degeneracy (N2: 2/3 or 1/3), as in the partition function.
    einstein_a : (L,) [s-1]
        Probability of spontaneous emission of the line, >= 0: from one state of the upper level to all
        states of the lower.
    natural_hwhm : (L,) [m-1]
    stark_hwhm : (L,) [m2] = [m-1 per m-3]
        :math:`w_S`, per electron density at :math:`T_0`.
    stark_exponent : (L,) [1]
        :math:`m`.
    van_der_waals_hwhm : (L,) [m2]
        :math:`w_W`, per density of neutral particles at :math:`T_0`.
    resonance_hwhm : (L,) [m2]
        :math:`w_R`, per density of the own species.
    upper_rotation, lower_rotation : (L,) [m-1]
        Part of the level energies that follows the rotational temperature: what lies above the
        rotationless vibronic level, spin splitting included. 0 for atoms.
    family : (L,) [1]
        Number of the multiplet or band of the line, 0 or more; of a band (v', v''): `BAND` v' + v''.
    strength_uncertainty : (L,) [1]
        Relative, of the Einstein coefficient; 0 where the list knows only that of the system.
    origin : weakest origin of the tables behind the list (see `tables.ORIGINS`)
    relative_uncertainty : float [1]
        Of the strength of the whole system, one standard deviation or what its source states; NaN if unknown.

    A scalar given for a number is spread over the lines.
    """

    component: str
    species: str
    wavenumber: np.ndarray
    upper_energy: np.ndarray
    lower_energy: np.ndarray
    upper_degeneracy: np.ndarray
    lower_degeneracy: np.ndarray
    einstein_a: np.ndarray
    natural_hwhm: np.ndarray = 0.0
    stark_hwhm: np.ndarray = 0.0
    stark_exponent: np.ndarray = 0.0
    van_der_waals_hwhm: np.ndarray = 0.0
    resonance_hwhm: np.ndarray = 0.0
    upper_rotation: np.ndarray = 0.0
    lower_rotation: np.ndarray = 0.0
    family: np.ndarray = 0.0
    strength_uncertainty: np.ndarray = 0.0
    origin: str = "published"
    relative_uncertainty: float = np.nan

    def __post_init__(self):
        shape = np.shape(self.wavenumber)
        if len(shape) != 1:
            raise ValueError(f"lines of {self.component}: wavenumber must be one-dimensional; got {shape}")
        for name, unit in _NUMBERS.items():
            guard = positive if name in _POSITIVE else non_negative
            if name in _SIGNED:
                values = np.asarray(getattr(self, name), dtype=float)
                if not np.isfinite(values).all():
                    raise ValueError(f"lines of {self.component}: {name} must be finite")
            else:
                values = guard(f"lines of {self.component}: {name}", getattr(self, name), unit)
            if values.shape not in ((), shape):
                raise ValueError(
                    f"lines of {self.component}: {name} has shape {values.shape}, wavenumber has {shape}"
                )
            object.__setattr__(self, name, np.broadcast_to(values, shape))
        gap = np.abs(self.upper_energy - self.lower_energy - self.wavenumber)
        if np.any(gap > ENERGY_CLOSURE * self.wavenumber):
            worst = int(np.argmax(gap / self.wavenumber))
            raise ValueError(
                f"lines of {self.component}: upper_energy - lower_energy must equal wavenumber; differ by"
                f" {gap[worst]:g} m-1 at index {worst}"
            )

    def __len__(self):
        return len(self.wavenumber)

    @cached_property
    def power(self):
        r"""What one particle in the upper level emits, :math:`h c \tilde\nu A / 4\pi` (L,) [W sr-1]."""
        return PLANCK * LIGHT_SPEED / (4 * np.pi) * self.wavenumber * self.einstein_a

    @cached_property
    def upper_vibration(self):
        """Energy of the upper levels without rotation, above the lowest (L,), and which there are [m-1]."""
        energy = self.upper_energy - self.upper_rotation
        energy = energy - energy.min()
        return energy, np.unique(np.round(energy / LEVEL_STEP)) * LEVEL_STEP

    def select(self, keep):
        """Return the list of the lines where `keep` (boolean or index array over the lines) says so."""
        parts = {field.name: getattr(self, field.name) for field in fields(self)}
        return LineList(**{name: value[keep] if name in _NUMBERS else value for name, value in parts.items()})


def once(values):
    """One element of an array that repeats a number (see `LineList`), else the array."""
    return values[:1] if values.strides == (0,) else values
