"""Populations away from equilibrium: two temperatures, and factors on single levels."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from plasmapyro.checks import non_negative, positive
from plasmapyro.constants import SECOND_RADIATION


@dataclass(frozen=True)
class Departure:
    """Factors on the populations of the levels of one radiating system, over those of the temperatures.

    `upper` and `lower` are each a number, an array (S,) over the layers of the path, or a function
    (energies of the levels (L,) [m-1], index of the layer) -> factors (L,), as `level_factors` makes.
    """

    upper: Any = 1.0
    lower: Any = 1.0

    def factors(self, lines, layer):
        """Factors of the upper and lower levels of a line list in a layer: two (L,), > 0 and >= 0 [1].

        ValueError: an upper factor not > 0, a lower one negative, or a shape that fits neither lines nor
        layers.
        """
        upper = _at(self.upper, lines.upper_energy, layer, f"{lines.component}, upper levels")
        lower = _at(self.lower, lines.lower_energy, layer, f"{lines.component}, lower levels")
        return (
            positive(f"population factor of {lines.component}, upper levels", upper, "1"),
            non_negative(f"population factor of {lines.component}, lower levels", lower, "1"),
        )


def _at(factor, energy, layer, what):
    """A factor of `Departure` for the levels of a line list in a layer (L,)."""
    if callable(factor):
        values = np.asarray(factor(energy, layer), dtype=float)
        if values.shape not in ((), energy.shape):
            raise ValueError(
                f"population factor of {what} must have the shape of the energies {energy.shape};"
                f" got {values.shape}"
            )
    else:
        values = np.asarray(factor, dtype=float)
        if values.ndim > 1 or (values.ndim == 1 and layer >= len(values)):
            raise ValueError(
                f"population factor of {what} must be a number or one per layer; got {values.shape}"
            )
        values = values[layer] if values.ndim else values
    return np.broadcast_to(values, energy.shape)


def level_factors(level_energy, factor, *, tolerance=20.0):
    """Factors (energy (L,), layer) -> (L,) of single levels, for `Departure`; every other level keeps 1.

    `factor` (E,): population over that of equilibrium of levels (E,) [m-1] above the lowest one of the
    species, `tolerance` [m-1]: how far off a line's level may lie. ValueError: shapes that differ, a negative
    factor or energy.
    """
    level_energy = np.atleast_1d(non_negative("level_energy", level_energy, "m-1"))
    factor = np.atleast_1d(non_negative("factor", factor, "1"))
    if level_energy.shape != factor.shape or level_energy.ndim != 1:
        raise ValueError(
            f"factor must have the shape of level_energy {level_energy.shape}; got {factor.shape}"
        )

    def look_up(energy, layer):
        nearest = np.abs(energy[:, None] - level_energy).argmin(axis=1)
        return np.where(np.abs(energy - level_energy[nearest]) <= tolerance, factor[nearest], 1.0)

    return look_up


def two_temperature_population(
    energy, rotation, degeneracy, temperature, excitation_temperature, number_density, partition_function
):
    r"""Number density of a level whose rotation has one temperature and whose excitation another.

    .. math:: n_i = n \frac{g_i}{Q(T, T_{ve})}
              \exp\left(-\frac{h c (\tilde E_i - \tilde E_{rot,i})}{k T_{ve}}
              - \frac{h c \tilde E_{rot,i}}{k T}\right)

    Source: C. Park, Nonequilibrium Hypersonic Aerothermodynamics (1990), section 1.3.

    ValueError: temperature not > 0, density negative.

    Parameters
    ----------
    energy, rotation : array_like [m-1]
        Of the level, and the part of it that is rotation.
    degeneracy : array_like [1]
    temperature, excitation_temperature : float [K]
    number_density : float [m-3]
        Of the species.
    partition_function : float [1]
        As `gas.partition.two_temperature_partition_function`.

    Returns
    -------
    ndarray [m-3]
    """
    temperature = positive("temperature", temperature, "K")
    excitation_temperature = positive("excitation_temperature", excitation_temperature, "K")
    number_density = non_negative("number_density", number_density, "m-3")
    exponent = energy / excitation_temperature + rotation * (1 / temperature - 1 / excitation_temperature)
    return number_density * degeneracy / partition_function * np.exp(-SECOND_RADIATION * exponent)


def absorption_excess(lines, temperature, excitation_temperature, upper_factor=1.0, lower_factor=1.0):
    r"""Absorption (L,) of lines over the one their emission would entail at the excitation temperature.

    .. math:: \rho = \frac{n_l g_u / n_u g_l - 1}{e^{h c \tilde\nu / k T_{ve}} - 1}, \qquad
              \int \kappa\, d\tilde\nu = \frac{A}{8\pi c \tilde\nu^2}
              \left(\frac{g_u}{g_l} n_l - n_u\right) = \rho\, \frac{\varepsilon}{B_{\tilde\nu}(T_{ve})}

    with :math:`n_l g_u / n_u g_l = (b_l/b_u) \exp\frac{hc}{k} [\tilde\nu/T_{ve} + (\tilde E_{rot,u} - \tilde
    E_{rot,l})(1/T - 1/T_{ve})]` and the factors b on the populations. In equilibrium it is 1, to the last
    bit; negative where stimulated emission outweighs absorption. Source: Einstein coefficients; Laux et al.,
    Plasma Sources Sci. Technol. 12 (2003) 125, section 2.
    """
    planck = SECOND_RADIATION * lines.wavenumber / excitation_temperature
    between = 1 / temperature - 1 / excitation_temperature
    exponent = planck + SECOND_RADIATION * (lines.upper_rotation - lines.lower_rotation) * between
    ratio = np.asarray(lower_factor) / upper_factor
    # ratio e^x - 1 without cancellation where the ratio is 1
    return (ratio * np.expm1(exponent) + (ratio - 1)) / np.expm1(planck)
