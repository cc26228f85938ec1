"""Lines of an electronic transition of a diatomic molecule, and which of them are too weak to keep."""

import numpy as np

from plasmapyro.checks import fraction, increasing, positive
from plasmapyro.constants import BOHR_RADIUS, ELEMENTARY_CHARGE, PLANCK, SECOND_RADIATION, VACUUM_PERMITTIVITY
from plasmapyro.radiation.diatomic_rotation import clebsch_gordan, parity

STEPS = (-1, 0, 1)  # J' - J'': P, Q and R branches
COLUMNS = (
    "wavenumber",
    "upper_energy",
    "lower_energy",
    "upper_degeneracy",
    "lower_degeneracy",
    "einstein_a",
    "upper_v",
    "lower_v",
    "upper_j",
    "lower_j",
    "upper_component",
    "lower_component",
)
FAINTEST_SHARE = 1e-9  # [1], of an upper level's decay into a band; below are rounding errors of zero

# A = EINSTEIN_FACTOR sigma^3 R^2 with R in e a0 and sigma in m-1 [s-1 m3]
EINSTEIN_FACTOR = 16 * np.pi**3 * (ELEMENTARY_CHARGE * BOHR_RADIUS) ** 2 / (3 * VACUUM_PERMITTIVITY * PLANCK)


def orbital_doubling(upper, lower):
    """2 for a Sigma upper and a Lambda-doubled lower state, else 1: lower levels each upper one reaches."""
    return 2 if upper.orbital == 0 < lower.orbital else 1


def rotational_shares(upper, upper_vector, lower, lower_vector, quantum_number, step, coupling):
    r"""Honl-London factors: shares of an upper level's decay into a band that go into each line.

    .. math::

        S = d\,\frac{2J''+1}{2J'+1}
            \Bigl|\sum_\Sigma c'_\Sigma c''_\Sigma \langle J''\,\Omega''\;1\,q | J'\,\Omega'\rangle\Bigr|^2,
            \qquad q = \Lambda' - \Lambda''

    with d = 2 for a Sigma lower and non-Sigma upper state (an upper level of one parity reaches half
    of the lower levels, twice as strongly), else 1. Then :math:`\sum_{J''F''} S = 1` exactly for each
    upper level of one parity.

    Source: J. T. Hougen, NBS Monograph 115 (1970), section 5; normalised as E. E. Whiting et al.,
    J. Mol. Spectrosc. 80 (1980) 249.

    Parameters
    ----------
    upper, lower : ElectronicState
    upper_vector, lower_vector : (J, Sigma, F) [1]
        Mixing of one vibrational level each, on the same quantum numbers.
    quantum_number : (J,) [1]
    step : int
        J' - J''.
    coupling : (J'', Sigma) [1]
        Of `photon_coupling`, which all bands of a transition share.

    Returns
    -------
    (J'', F', F'') [1]
        Zero where J'' + step is not among the quantum numbers.
    """
    partner = np.arange(len(quantum_number)) + step
    inside = (partner >= 0) & (partner < len(quantum_number))
    vector = upper_vector[np.clip(partner, 0, len(quantum_number) - 1)] * inside[:, None, None]
    amplitude = (vector[:, :, :, None] * lower_vector[:, :, None, :] * coupling[:, :, None, None]).sum(axis=1)
    doubling = 2 if upper.orbital > 0 and lower.orbital == 0 else 1
    ratio = (2 * quantum_number + 1) / np.maximum(2 * (quantum_number + step) + 1, 1)
    return doubling * ratio[:, None, None] * amplitude**2


def photon_coupling(upper, lower, quantum_number, step):
    """Clebsch-Gordan coefficients (J'', Sigma) [1] of all bands of a transition for one J' - J''."""
    projection = upper.orbital + upper.projection
    return clebsch_gordan(quantum_number[:, None], step, projection, upper.orbital - lower.orbital)


def nuclear_weight(state, level_parity, nuclear_spin):
    """Weight [1] of nuclear spin of levels of two equal nuclei with integer spin I, over :math:`(2I+1)^2`.

    Levels symmetric in the nuclei (total parity + of g states, - of u states) have :math:`(I+1)/(2I+1)`,
    antisymmetric ones :math:`I/(2I+1)`; different nuclei have 1. Source: G. Herzberg, Spectra of Diatomic
    Molecules (1950), section III,2f.
    """
    if not state.inversion:
        return np.ones(np.shape(level_parity))
    symmetric = np.asarray(level_parity) * (1 if state.inversion == "g" else -1) > 0
    return np.where(symmetric, nuclear_spin + 1, nuclear_spin) / (2 * nuclear_spin + 1)


def transition_lines(upper, lower, moment, wavenumber_range, nuclear_spin):
    r"""Every rotational line of an electronic transition within a range.

    .. math:: A = K\, g\, \tilde\nu^3\, R_{v'v''}^2\, S, \qquad K = \frac{16 \pi^3 (e a_0)^2}{3 \epsilon_0 h}

    with the line's own wavenumber, and g = 2 for a Sigma upper and Pi lower state, else 1.

    Source: E. E. Whiting et al., J. Mol. Spectrosc. 80 (1980) 249; the moment is the one of C. O. Laux,
    C. H. Kruger, JQSRT 48 (1992) 9. Lines of the two parities of a Pi-Pi transition coincide and are
    given once with the weight of both.

    Parameters
    ----------
    upper, lower : Levels
        On the same quantum numbers J.
    moment : (3, v', v'', J'') [e a0]
        :math:`R_{v'v''}` for J' - J'' = -1, 0, 1; broadcasts.
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.
    nuclear_spin : int [1]
        I of two equal nuclei; not used for different nuclei.

    Returns
    -------
    dict of (L,) arrays
        wavenumber, upper_energy, lower_energy [m-1], upper_degeneracy, lower_degeneracy [1],
        einstein_a [s-1], upper_v, lower_v, upper_j, lower_j [1], upper_component, lower_component (the
        index of F, from 0 in ascending energy) [1]; ascending wavenumber.
    """
    low, high = increasing("wavenumber_range", wavenumber_range, "m-1")
    momentum = lower.quantum_number
    bands = (len(upper.energy), len(lower.energy))
    moment = np.broadcast_to(moment, (len(STEPS), *bands, len(momentum)))
    weight = _line_weights(upper, lower, nuclear_spin)
    strength = EINSTEIN_FACTOR * orbital_doubling(upper.state, lower.state)
    component = np.arange(upper.state.multiplicity)
    couplings = [photon_coupling(upper.state, lower.state, momentum, step) for step in STEPS]
    parts = []
    for v_upper, v_lower in np.ndindex(bands):
        for index, step in enumerate(STEPS):
            first, last = max(0, -step), len(momentum) - max(0, step)
            below, above = slice(first, last), slice(first + step, last + step)
            energy_upper = upper.energy[v_upper, above, :, None]
            energy_lower = lower.energy[v_lower, below, None, :]
            wavenumber = energy_upper - energy_lower
            keep = (wavenumber >= low) & (wavenumber <= high)
            keep &= upper.exists[v_upper, above, :, None] & lower.exists[v_lower, below, None, :]
            if not keep.any():
                continue
            vectors = (upper.state, upper.vector[v_upper], lower.state, lower.vector[v_lower])
            share = rotational_shares(*vectors, momentum, step, couplings[index])[below]
            keep &= share > FAINTEST_SHARE
            square = moment[index, v_upper, v_lower, below, None, None] ** 2
            quantum = momentum[below, None, None]
            columns = (
                wavenumber,
                energy_upper,
                energy_lower,
                (2 * (quantum + step) + 1) * weight(v_upper, v_lower, above, below),
                (2 * quantum + 1) * weight(v_upper, v_lower, above, below),
                strength * wavenumber**3 * square * share,
                v_upper,
                v_lower,
                quantum + step,
                quantum,
                component[:, None],
                component,
            )
            parts.append([np.broadcast_to(column, keep.shape)[keep] for column in columns])
    if not parts:
        return {name: np.zeros(0) for name in COLUMNS}
    joined = [np.concatenate(column) for column in zip(*parts, strict=True)]
    order = np.argsort(joined[0], kind="stable")
    return {name: column[order] for name, column in zip(COLUMNS, joined, strict=True)}


def _line_weights(upper, lower, nuclear_spin):
    """Nuclear weight of the lines of a band, as a function (v', v'', J' slice, J'' slice) -> (J, F', F'')."""
    if lower.state.orbital == 0:
        table = nuclear_weight(lower.state, parity(lower), nuclear_spin)
        return lambda v_upper, v_lower, above, below: table[v_lower, below, None, :]
    if upper.state.orbital == 0:
        table = nuclear_weight(upper.state, parity(upper), nuclear_spin)
        return lambda v_upper, v_lower, above, below: table[v_upper, above, :, None]
    both = nuclear_weight(upper.state, np.array([1.0, -1.0]), nuclear_spin).sum()
    return lambda v_upper, v_lower, above, below: both


def emission_weights(lines, temperature):
    r"""Relative emission (L,) of lines in thermal equilibrium, :math:`g' A \tilde\nu \exp(-E'/kT)`, sum 1."""
    temperature = positive("temperature", temperature, "K")
    energy = lines["upper_energy"] - lines["upper_energy"].min()
    weight = lines["upper_degeneracy"] * lines["einstein_a"] * lines["wavenumber"]
    weight = weight * np.exp(-SECOND_RADIATION * energy / temperature)
    return weight / weight.sum()


def strong_enough(lines, temperatures, lost_fraction):
    """Which lines (L,) to keep so that little of the optically thin emission is lost at each temperature.

    A line stays when, at one of the temperatures (T,) [K], it is not among the faintest ones that together
    emit less than `lost_fraction` (in (0, 1]) of the whole list.
    """
    lost_fraction = fraction("lost_fraction", lost_fraction)
    keep = np.zeros(len(lines["wavenumber"]), dtype=bool)
    for temperature in temperatures:
        weight = emission_weights(lines, temperature)
        order = np.argsort(weight, kind="stable")
        keep[order] |= np.cumsum(weight[order]) > lost_fraction
    return keep
