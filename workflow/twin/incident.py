"""The gas that shines on the stagnation point: how much of it, at which temperature, from where.

A flow field is read as data: temperatures on the triangles of an axisymmetric mesh. It is sorted into
directions and temperatures once; the light of anything that depends on temperature alone is then a product.
"""

from dataclasses import dataclass

import numpy as np

SECOND = 1.438776877  # [cm K] h c / k
CLOSE, COUNT = 5.0, 10  # [deg] and number of equal steps of direction: the torch, seen end on
BEYOND = 20  # steps in the logarithm from there to 90 degrees
# Degeneracy and energy [cm-1] of the levels of the atoms: NIST Atomic Spectra Database.
LEVELS = {
    "N": ((4, 0.0), (10, 19228.0), (6, 28839.0)),
    "O": ((5, 0.0), (3, 158.3), (1, 227.0), (5, 15867.9), (1, 33792.6)),
}
# Degeneracy, energy, vibration, its anharmonicity and rotation [cm-1] of electronic states:
# K. P. Huber & G. Herzberg, Constants of Diatomic Molecules (1979).
STATES = {
    "N2": ((1, 0.0, 2358.6, 14.32, 1.998), (3, 50203.6, 1460.6, 13.87, 1.455)),
    "N2+": (
        (2, 0.0, 2207.0, 16.10, 1.932),
        (4, 9166.9, 1903.7, 15.02, 1.744),
        (2, 25461.4, 2419.8, 23.18, 2.083),
    ),
    "NO": ((4, 60.0, 1904.2, 14.08, 1.672),),
}
VIBRATION = 40  # levels
MASS = {"N": 14.007, "O": 15.999}
IONIZATION = {"N": 117225.7, "O": 109837.0}  # [cm-1]: NIST, as above
IONS = {"N": 9, "O": 4}  # statistical weight of the ground state of the ion
# Half width of O I 777 per electrons [m4], binding of its upper level [cm-1]: H. R. Griem, Spectral Line
# Broadening by Plasmas (1974).
STARK, STARK_PLACE, STARK_BINDING = 3.15e-12 / 1e22, 777.4e-9, 23208.0
INFRARED = 10500.0  # [cm-1] photons at 950 nm
AFFINITY, ATTACHING = 11784.0, 13000.0  # [cm-1] of O, and photons that attachment sends out: above it


@dataclass(frozen=True)
class View:
    """Gas seen from the stagnation point.

    `solid_angle` (A,) [sr] of rings of direction, times the cosine: their sum is pi; `path` (A, T) [m]: mean
    length of gas at the temperatures of a table, what lies between two of them shared linearly.
    """

    solid_angle: np.ndarray
    path: np.ndarray

    def mean(self, values):
        """Mean over the half space, weighted with the cosine, of (A, ...)."""
        return np.tensordot(self.solid_angle, values, axes=1) / self.solid_angle.sum()


def view(flow, temperature):
    r"""`View` from a flow field, on temperatures (T,) [K].

    A ring of gas at :math:`(z, r)` fills :math:`2\pi r\,dz\,dr\,\cos\theta/d^2` of the projected half space,
    times its depth. Triangles are integrated by the middles of their sides, exact for parabolas.
    """
    z, r = flow["node_z"].values, flow["node_r"].values
    corner, middle = flow["face_node"].values, flow["face_midnode"].values
    (za, zb, zc), (ra, rb, rc) = z[corner].T, r[corner].T
    area = np.abs((zb - za) * (rc - ra) - (zc - za) * (rb - ra)) / 2
    ahead = float(flow.attrs["stagnation_point_z"]) - z[middle]
    aside, kelvin = r[middle], flow["temperature"].values[middle]
    share = np.broadcast_to(area[:, None] / 3, middle.shape)
    front = ahead > 0
    ahead, aside, kelvin, share = (values[front] for values in (ahead, aside, kelvin, share))
    weight = 2 * np.pi * aside * share * ahead / np.hypot(ahead, aside) ** 3
    close = np.linspace(0, CLOSE, COUNT + 1)
    edges = np.radians(np.concatenate([close, np.geomspace(CLOSE, 90.0, BEYOND + 1)[1:]]))
    solid = np.pi * np.diff(np.sin(edges) ** 2)
    ring = np.clip(np.searchsorted(edges, np.arctan2(aside, ahead)) - 1, 0, solid.size - 1)
    path = np.zeros((solid.size, temperature.size))
    _deposit(path, ring, kelvin, weight, temperature)
    return View(solid, path / solid[:, None])


def along(distance, kelvin, temperature):
    """Length (T,) [m] of gas at each temperature of a table, along a path (Z,) [m]."""
    path = np.zeros((1, temperature.size))
    step = np.diff(distance)
    weight = (np.append(step, 0.0) + np.append(0.0, step)) / 2
    _deposit(path, np.zeros(distance.size, dtype=int), kelvin, weight, temperature)
    return path[0]


def _deposit(path, ring, kelvin, weight, temperature):
    low = np.clip(np.searchsorted(temperature, kelvin) - 1, 0, temperature.size - 2)
    upper = np.clip((kelvin - temperature[low]) / (temperature[low + 1] - temperature[low]), 0.0, 1.0)
    np.add.at(path, (ring, low), weight * (1 - upper))
    np.add.at(path, (ring, low + 1), weight * upper)


def partition(species, temperature):
    """Partition function (T,) per volume of an atom or, rigid and anharmonic, a molecule."""
    if species in LEVELS:
        return sum(g * np.exp(-SECOND * energy / temperature) for g, energy in LEVELS[species])
    v = np.arange(VIBRATION)[:, None]
    return sum(
        g
        * np.exp(-SECOND * (energy + vibration * v - anharmonic * v * (v + 1)) / temperature).sum(axis=0)
        * temperature
        / (SECOND * rotation)
        for g, energy, vibration, anharmonic, rotation in STATES[species]
    )


def stark(species, energy, place):
    """Half width [m4] per electron density of lines at `place` [m], upper level `energy` [cm-1].

    ASSUME: it goes with the square of the wavelength and of the size of the upper orbit.
    """
    return STARK * (place / STARK_PLACE) ** 2 * (STARK_BINDING / (IONIZATION[species] - energy)) ** 2


def emission(system, species, energy, temperature, density):
    """Relative emission (T,) of a system in equilibrium, of the upper level `energy` [cm-1] if it has one.

    ASSUME: bands of molecules but N2 1P come with all rotation of the upper level; continua are those of
    photons at 950 nm, but for attachment. Of the neutral particles N alone counts, whose negative ion is
    nearly bound: C. A. Ramsbottom, K. L. Bell & K. A. Berrington, J. Phys. B 25, 1443 (1992), absorption that
    falls as T^-1.2 from 4000 to 7000 K. Electrons recombine with ions of N and O, as many as Saha's law says,
    into levels as dense as those of hydrogen: A. Unsold, Ann. Phys. 425, 607 (1938).
    """
    electrons = density["e-"]
    photon = np.exp(-SECOND * INFRARED / temperature)
    if system == "e-ion free-free":
        return electrons**2 / np.sqrt(temperature) * photon
    if system == "free-bound":
        ionized = sum(
            density[atom]
            * weight
            * np.exp(-SECOND * IONIZATION[atom] / temperature)
            / partition(atom, temperature)
            for atom, weight in IONS.items()
        )
        return ionized * temperature * (1 - photon)
    if system == "e-neutral free-free":
        return electrons * density["N"] * temperature**-1.2 * photon
    if system == "O- detachment":
        bound = np.exp(SECOND * (AFFINITY - ATTACHING) / temperature)
        return electrons * density["O"] * temperature**-1.5 * bound
    level = density[species] / partition(species, temperature) * np.exp(-SECOND * energy / temperature)
    return level if species in LEVELS or system == "N2 1P" else level * temperature
