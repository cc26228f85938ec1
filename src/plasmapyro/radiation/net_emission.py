r"""Power that a hot gas radiates per volume, vacuum ultraviolet to infrared, less what it takes up again.

In the middle of a uniform sphere of radius R (R. L. Liebermann and J. J. Lowke, J. Quant. Spectrosc. Radiat.
Transfer 16 (1976) 253):

.. math:: q_{rad} = 4\pi \Big[\sum_l \varepsilon_l \int \phi_l\, e^{-\kappa_l R\,\phi_l}\,d\tilde\nu
          + \int \kappa_c B_\lambda\, e^{-\kappa_c R}\,d\lambda\Big]

At R = 0 nothing is taken up. Each line absorbs itself alone, by its own Voigt profile. In: the lines
of N I and O I that carry weight, lines of ions and bands from 650 to 1250 nm (nothing of these is taken up),
recombination to all levels, free electrons. Left out: bands and lines of ions beyond that range.
"""

import numpy as np
import xarray as xr
from scipy.special import wofz

from plasmapyro import tables
from plasmapyro.checks import non_negative
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import IONS, SPECIES, gas_name, nitrogen_of, particle_mass
from plasmapyro.radiation.atoms import ATOMS, TABLE_RANGE, atomic_lines
from plasmapyro.radiation.broadening import doppler_sigma, natural_hwhm, resonance_hwhm
from plasmapyro.radiation.continuum import electron_atom_absorption, electron_ion_absorption
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.lines import LineList
from plasmapyro.radiation.path import nodes_path
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.systems import line_lists
from plasmapyro.tables import weakest

SELF_ABSORBED = ("N I", "O I")
STEP = 10  # the emission is given at every tenth temperature of the gas table
RANGE = (62e-9, 4.7e-6)  # [m], of the photon energies of the photoionisation table
GRID_POINTS = 2000  # over `TABLE_RANGE`, only to choose its lines
THIN = 1e-4  # optical depth in the middle of a line below which none of it is taken up
PROFILE = np.concatenate([[0.0], np.geomspace(0.05, 3e4, 90)])  # offsets in Doppler widths
COLDEST = 3000.0  # [K], of the photoionisation table; atoms and electrons of colder gas do not count
LEAST_BINDING = 1e5  # [m-1], of levels that nearly touch a limit
GROUND_TERMS = 3e6  # [m-1]: lines to levels below that also broaden by exchange with atoms of their kind


def net_emission(gas, absorption_radius=0.0):
    """Net emission (contract 'net_emission') of the gas of a table in equilibrium.

    At its pressures and every tenth of its temperatures; `absorption_radius` [m]: of the hot gas that takes
    up its own light; 0 for none. ASSUME: local thermal equilibrium; lines do not overlap, and the continuum
    does not take up lines.
    """
    radius = float(non_negative("absorption_radius", absorption_radius, "m"))
    temperature = gas.temperature.values[::STEP].astype(float)
    inside = line_lists(log_grid(TABLE_RANGE, GRID_POINTS))
    atoms = [one for one in inside if one.component in SELF_ABSORBED] + [
        _beyond(one) for one in SELF_ABSORBED
    ]
    thin = _per_particle(temperature, [one for one in inside if one.component not in SELF_ABSORBED])
    recombination = Photoionisation()
    rows = []
    for pressure in gas.pressure.values:
        density = number_density(temperature, pressure, nitrogen_of(gas)).T
        path = nodes_path(temperature, dict(zip(SPECIES, density, strict=True)))
        whole = sum(path.number_density[name] * light for name, light in thin.items())
        for layer in np.flatnonzero(temperature >= COLDEST):
            whole[layer] += recombination.light(path, layer, radius) + _of_lines(atoms, path, layer, radius)
        rows.append(4 * np.pi * whole)
    return xr.Dataset(
        {"net_emission": (("pressure", "temperature"), np.array(rows))},
        {"pressure": gas.pressure.values, "temperature": temperature},
        attrs={
            "title": "Net emission of a gas in equilibrium",
            "gas": gas_name(nitrogen_of(gas)),
            "absorption_radius": radius,
            "wavelength_range": [float(edge) for edge in RANGE],
            "origin": weakest(["modelled", *(lines.origin for lines in [*inside, *atoms])]),
        },
    )


def _per_particle(temperature, lists):
    """Light of line lists that take up nothing, by species, per particle (T,) [W sr-1]."""
    single = nodes_path(temperature, {name: np.ones_like(temperature) for name in SPECIES})
    found = {}
    for lines in lists:
        light = np.array([single.emission(lines, layer).sum() for layer in range(temperature.size)])
        found[lines.species] = found.get(lines.species, 0.0) + light
    return found


def _beyond(system):
    """Lines of an atom outside the range of its table; Stark widths by the binding, as of those in it."""
    atom, table = ATOMS[system], tables.load("radiation/loss_lines")
    mine = table["system"] == system
    upper, lower, g_upper, g_lower, einstein = (
        table[name][mine]
        for name in ("upper_energy", "lower_energy", "upper_degeneracy", "lower_degeneracy", "einstein_a")
    )
    known = atomic_lines(system)
    law = np.polyfit(np.log(_binding(atom, known.upper_energy)), np.log(known.stark_hwhm), 1)
    exchanged = np.where(lower < GROUND_TERMS, einstein, 0.0)
    nothing = np.zeros(upper.size)
    return LineList(
        component=system,
        species=atom.species,
        wavenumber=upper - lower,
        upper_energy=upper,
        lower_energy=lower,
        upper_degeneracy=g_upper,
        lower_degeneracy=g_lower,
        einstein_a=einstein,
        natural_hwhm=natural_hwhm(einstein, nothing),
        stark_hwhm=np.exp(np.polyval(law, np.log(_binding(atom, upper)))),
        stark_exponent=np.full(upper.size, np.median(known.stark_exponent)),
        van_der_waals_hwhm=nothing,
        resonance_hwhm=resonance_hwhm(upper - lower, exchanged, g_upper, g_lower),
        origin=table.origin,
        relative_uncertainty=0.0,
    )


def _binding(atom, energy):
    """Energy [m-1] below the lowest ionisation limit above a level (of an excited core, for some)."""
    limits = np.sort(list(atom.limits.values()))
    place = np.minimum(np.searchsorted(limits, energy), limits.size - 1)
    return np.maximum(limits[place] - energy, LEAST_BINDING)


def escape(depth, ratio):
    r"""Share of a line's light that leaves the middle of a sphere, :math:`\int\phi\,e^{-\kappa R\phi}d\nu`.

    `depth` [1] :math:`\kappa R` over the Doppler width (sqrt 2 sigma), optical depth for a profile of unit
    area in that unit; `ratio` [1] of the Lorentz half width to it.
    """
    profile = wofz(PROFILE + 1j * np.maximum(ratio, 1e-6)[..., None]).real / np.sqrt(np.pi)
    beyond = ratio / np.pi / PROFILE[-1]  # area of the wing that the offsets leave out, thin by then
    passed = np.exp(-depth[..., None] * profile)

    def area(share):
        return np.trapezoid(profile * share, PROFILE, axis=-1) + beyond * share[..., -1]

    return area(passed) / area(np.ones_like(passed))


def _of_lines(lists, path, layer, radius):
    """Light of the lines of atoms [W m-3 sr-1] that is not taken up."""
    temperature, total = path.temperature[layer], 0.0
    for lines in lists:
        emission = path.emission(lines, layer)
        total += emission.sum()
        if radius == 0 or not emission.any():
            continue
        wavelength = 1 / lines.wavenumber
        # Kirchhoff's law with B per wavenumber, B_lambda lambda^2.
        absorbed = emission / (blackbody_radiance(wavelength, temperature) * wavelength**2)
        width = np.sqrt(2) * doppler_sigma(temperature, particle_mass(lines.species)) * lines.wavenumber
        thick = np.flatnonzero(absorbed * radius / width > THIN)
        if not thick.size:
            continue
        depth, ratio = (absorbed * radius / width)[thick], (path.hwhm(lines, layer) / width)[thick]
        total -= emission[thick] @ (1 - escape(depth, ratio))
    return total


class Photoionisation:
    """Continuous light of recombination and of free electrons, on the bins of the photoionisation table."""

    def __init__(self):
        table = tables.load("radiation/loss_photoionisation")
        names = [name for name in table.columns if name.startswith("at_")]
        self.inverse = np.array([1 / float(name.split("_")[1]) for name in names])
        self.wavenumber = table["photon"][table["species"] == "N"]
        self.logarithm = {
            atom: np.log(np.stack([table[name][table["species"] == atom] for name in names]))
            for atom in ("N", "O")
        }
        self.limit = {atom: min(ATOMS[f"{atom} I"].limits.values()) for atom in ("N", "O")}

    def absorption(self, path, layer):
        """Absorption coefficient (W,) [m-1], stimulated emission taken off."""
        temperature = path.temperature[layer]
        density = {name: values[layer] for name, values in path.number_density.items()}
        ratio = SECOND_RADIATION * self.wavenumber / temperature
        found = electron_ion_absorption(
            self.wavenumber, temperature, density["e-"], sum(density[name] for name in IONS)
        )
        rising = np.argsort(self.inverse)
        for atom, table in self.logarithm.items():
            found += electron_atom_absorption(
                atom, self.wavenumber, temperature, density["e-"], density[atom]
            )
            log = [np.interp(1 / temperature, self.inverse[rising], one[rising]) for one in table.T]
            missing = SECOND_RADIATION * np.maximum(self.limit[atom] - self.wavenumber, 0.0) / temperature
            per_atom = np.exp(np.array(log) - missing) / path.partition[atom][layer]
            found += density[atom] * per_atom * -np.expm1(-ratio)
        return found

    def light(self, path, layer, radius):
        """What is not taken up [W m-3 sr-1]."""
        absorbed, wavelength = self.absorption(path, layer), 1 / self.wavenumber
        light = absorbed * blackbody_radiance(wavelength, path.temperature[layer])
        return float(-np.trapezoid(light * np.exp(-absorbed * radius), wavelength))
