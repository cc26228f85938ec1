r"""Induction equation of the coil and the plasma, for a time-harmonic azimuthal electric field.

.. math:: E = E_p - i\omega A_c, \qquad
    -\nabla^2 E_p + E_p/r^2 + i\omega\mu_0\sigma\,E_p = i\omega\mu_0\sigma\,(i\omega A_c)

A_c is the vector potential of the coil rings in closed form, so that no coil has to be meshed and the
unknown E_p is smooth. Weak form over flow domain and box, weight r dz dr, E_p = 0 on the axis and far away.
Per unit coil amplitude; amplitudes are peak values, q and F are means over a period:
``q = sigma |E|^2 / 2``,  F = Re(J x B*) / 2  with J = sigma E and B = (i/omega) curl E.

Source: same physics as Fagnani et al., LTE torch model; vector-potential form after Xue, Proulx and
Boulos, J. Phys. D 34 (2001) 1897. Deviation: the coil field is subtracted in closed form.
"""

from copy import copy
from dataclasses import dataclass

import numpy as np

from plasmapyro.constants import VACUUM_PERMEABILITY
from plasmapyro.flow.elements import Space
from plasmapyro.flow.linear import Factorised, Factors, dissection

AGM_STEPS = 6  # quadratic convergence: round-off from a modulus of 1 - 1e-6 on
DIFFERENCE = 1e-6  # [m]: central difference of A_c, error 1e-10 relative at 30 mm from the rings


def ring_potential(r, z, ring_radius, ring_positions):
    r"""Azimuthal vector potential of coaxial rings that carry 1 A each.

    .. math:: A = \frac{\mu_0}{\pi}\frac{\sqrt q}{2 r}\,[(1 - k^2/2) K - E], \quad
        q = (a + r)^2 + (z - z_0)^2,\; k^2 = 4 a r / q

    The bracket is K S with S = sum_{n>=1} 2^(n-1) c_n^2 from the arithmetic-geometric mean, which does
    not cancel near the axis as the difference of the elliptic integrals does.

    Source: Jackson, Classical Electrodynamics, 3rd ed., eq. 5.37; Abramowitz and Stegun 17.6.3-17.6.4.

    Parameters
    ----------
    r, z : arrays of one shape [m], r > 0
    ring_radius : float [m]
    ring_positions : sequence of z_0 [m]

    Returns
    -------
    ndarray [V s m-1 per A]
    """
    potential = np.zeros(np.shape(r))
    for position in ring_positions:
        q = (ring_radius + r) ** 2 + (z - position) ** 2
        complement = np.sqrt(((ring_radius - r) ** 2 + (z - position) ** 2) / q)
        # c_1 = (1 - k')/2 written as k^2 / (2 (1 + k')) keeps its digits for small k.
        c = 4 * ring_radius * r / q / (2 * (1 + complement))
        a, b = (1 + complement) / 2, np.sqrt(complement)
        total = c * c
        for n in range(2, AGM_STEPS + 1):
            c = (a - b) / 2
            total = total + 2 ** (n - 1) * c * c
            a, b = (a + b) / 2, np.sqrt(a * b)
        potential += VACUUM_PERMEABILITY * np.sqrt(q) / (2 * np.pi * r) * (np.pi / (2 * a)) * total
    return potential


@dataclass(frozen=True)
class Coupling:
    """Fields in the plasma at quadrature points (E, Q), SI; `power` is the integral of the heating [W].

    `electric_field` (complex) and `scattered` (dofs of E_p) belong to 1 A of coil amplitude whatever the
    scale of the heating and the forces.
    """

    power: float
    joule_heating: np.ndarray
    force_axial: np.ndarray
    force_radial: np.ndarray
    electric_field: np.ndarray
    scattered: np.ndarray
    tangent: "Tangent | None" = None


@dataclass(frozen=True)
class Tangent:
    """Derivative of the fields for 1 A with respect to the conductivity; made by `Induction.solve`."""

    induction: "Induction"
    factors: Factors
    conductivity: np.ndarray
    electric: np.ndarray
    magnetic_r: np.ndarray
    magnetic_z: np.ndarray

    def __call__(self, change):
        r"""Changes of heating, axial and radial force for a change of conductivity (E, Q) [S m-1].

        .. math:: K\,\delta E_p = -i\omega\mu_0\,\delta\sigma\,E, \qquad
            \delta q = \tfrac12\delta\sigma |E|^2 + \sigma\,\mathrm{Re}(E^*\delta E_p)

        and in the same way for the forces. Good to 1e-5 (factors in single precision): it serves the
        iteration of `coupled`, and is no result.
        """
        other = self.induction
        electric = other.scattered_by(self.factors, change * self.electric)
        value, slope_z, slope_r = electric
        omega, sigma = other.angular_frequency, self.conductivity
        magnetic_r = -1j / omega * slope_z
        magnetic_z = 1j / omega * (slope_r + value / other.plasma.r)

        def force(magnetic, magnetic_change):
            direct = change * np.real(self.electric * np.conj(magnetic))
            return direct + sigma * np.real(
                value * np.conj(magnetic) + self.electric * np.conj(magnetic_change)
            )

        heating = 0.5 * change * np.abs(self.electric) ** 2 + sigma * np.real(np.conj(self.electric) * value)
        return (heating, -0.5 * force(self.magnetic_r, magnetic_r), 0.5 * force(self.magnetic_z, magnetic_z))


class Induction:
    """The induction equation on the mesh of flow domain and box, ready for any conductivity.

    Parameters
    ----------
    mesh : MeshTri
        Subdomain 'flow', boundaries 'axis' and 'far'.
    frequency : float [Hz]
    potential : function (r, z) -> A_c [V s m-1 per A]
        Vector potential of the coil for 1 A; r > 0.
    order : int
        Element order, 1 or 2.
    """

    def __init__(self, mesh, frequency, potential, order=2):
        self.angular_frequency = 2 * np.pi * frequency
        self._coil_potential = potential
        self._space = Space(mesh, (order,))
        self.plasma = self._space.subset(mesh.subdomains["flow"])
        whole = self._space.cells
        derivatives = np.zeros((*whole.r.shape, 3, 3))
        derivatives[..., 0, 0] = 1 / whole.r**2
        derivatives[..., 1, 1] = derivatives[..., 2, 2] = 1.0
        self._vacuum = self._space.gathered(whole, self._space.element_matrices(whole, derivatives))
        fixed = self._space.boundary_dofs(0, ("axis", "far"))
        self._free = np.setdiff1d(np.arange(self._space.size), fixed)
        self._factorised = Factorised(self._free, self._free, dissection(mesh))
        z, r = self.plasma.z, self.plasma.r

        self._potential = potential(r, z)
        self._potential_z = (potential(r, z + DIFFERENCE) - potential(r, z - DIFFERENCE)) / (2 * DIFFERENCE)
        # Quadrature points may lie closer to the axis than the difference step.
        step = np.minimum(DIFFERENCE, r / 2)
        self._potential_r = (potential(r + step, z) - potential(r - step, z)) / (2 * step)

    def at_frequency(self, frequency):
        """The same equation at another frequency [Hz]; mesh and bases are shared."""
        other = copy(self)
        other.angular_frequency = 2 * np.pi * frequency
        return other

    def solve(self, conductivity):
        """Fields for 1 A of coil amplitude, of a conductivity (E, Q) [S m-1] >= 0 of the flow triangles."""
        omega, space, plasma = self.angular_frequency, self._space, self.plasma
        strength = omega * VACUUM_PERMEABILITY * conductivity
        derivatives = np.zeros((*strength.shape, 3, 3))
        derivatives[..., 0, 0] = strength
        data = self._vacuum + 1j * space.gathered(plasma, space.element_matrices(plasma, derivatives))
        load = np.zeros((3, *strength.shape))
        # Coil term on the right-hand side: i omega mu0 sigma (i omega A_c) = -omega^2 mu0 sigma A_c.
        load[0] = -strength * omega * self._potential
        scattered = np.zeros(space.size, dtype=complex)
        factors = self._factorised.system(space.matrix(data)).factors(single=True)
        scattered[self._free] = factors.solve(space.residual(plasma, load)[self._free].astype(complex))
        value, slope_z, slope_r = space.inputs(plasma, scattered)
        electric = value - 1j * omega * self._potential
        magnetic_r = -1j / omega * (slope_z - 1j * omega * self._potential_z)
        magnetic_z = 1j / omega * (slope_r - 1j * omega * self._potential_r + electric / plasma.r)
        heating = 0.5 * conductivity * np.abs(electric) ** 2
        return Coupling(
            power=float((heating * plasma.weight).sum()),
            joule_heating=heating,
            force_axial=-0.5 * conductivity * np.real(electric * np.conj(magnetic_r)),
            force_radial=0.5 * conductivity * np.real(electric * np.conj(magnetic_z)),
            electric_field=electric,
            scattered=scattered,
            tangent=Tangent(self, factors, conductivity, electric, magnetic_r, magnetic_z),
        )

    def scattered_by(self, factors, current):
        """Value, d/dz, d/dr (3, E, Q) of the field that a complex current density (E, Q) [A m-2] scatters."""
        space = self._space
        source = space.load(self.plasma, current.real) + 1j * space.load(self.plasma, current.imag)
        scattered = np.zeros(space.size, dtype=complex)
        strength = -1j * self.angular_frequency * VACUUM_PERMEABILITY
        scattered[self._free] = factors.solve_roughly(strength * source[self._free])[0]
        return space.inputs(self.plasma, scattered)

    def field_at(self, z, r, scattered):
        """Electric field at nodes (z, r) of the flow triangles for 1 A of coil amplitude [V m-1], complex."""
        place = {point: index for index, point in enumerate(map(tuple, self._space.points(0).T))}
        field = np.zeros(len(z), dtype=complex)
        off = np.flatnonzero(r > 0)
        nodes = np.array([place[z[index], r[index]] for index in off])
        potential = self._coil_potential(r[off], z[off])
        field[off] = scattered[nodes] - 1j * self.angular_frequency * potential
        return field
