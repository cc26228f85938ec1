"""Radiance of a path through gas, in equilibrium or not: all systems, layer by layer."""

from dataclasses import dataclass, field

import numpy as np

from plasmapyro.checks import non_negative, within
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.partition import partition_function, two_temperature_partition_function
from plasmapyro.gas.species import IONS, NEUTRALS, SPECIES, TRACE_IONS, TRACE_NEUTRALS, TRACES, particle_mass
from plasmapyro.progress import step
from plasmapyro.radiation.broadening import doppler_sigma, lorentz_hwhm
from plasmapyro.radiation.continuum import (
    bound_free,
    electron_atom_absorption,
    electron_ion_absorption,
    electron_nitrogen_molecule_absorption,
    free_bound_absorption,
    photodetachment_absorption,
)
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.opacity import (
    boltzmann_population,
    line_emission,
    prepare,
    require_resolution,
    spread,
)
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.populations import absorption_excess, two_temperature_population
from plasmapyro.radiation.transfer import cross_layer, layer_thickness

CONTINUA = ("e-ion free-free", "e-neutral free-free", "free-bound", "O- detachment")
CONTINUUM_POINTS = 2000  # of the coarse axis of the smooth parts, 0.25 nm; resolves the TOPbase resonances
TEMPERATURE_RANGE = (200.0, 15000.0)  # [K], of the partition functions and continuum tables
NEGLIGIBLE = 1e-6  # [1], of the radiance; what layers may contribute in total to be left out
DARK_TEMPERATURE = 300.0  # [K]; fainter than `NEGLIGIBLE` of a black body like the instrument itself is dark
RESOLVED_SHARE = 1e-3  # [1], of the whole thin emission; the grid need not resolve systems fainter than that
SHINES = 4000.0  # [K]; air hotter than that shines, whatever its length
UNRESOLVED_SHARE = 0.01  # [1], of a system's emission that may come from layers colder than the grid resolves


@dataclass(frozen=True)
class GasPath:
    """Layers of a path, in order towards the observer: thickness, temperature (S,), densities by species.

    Vibration, electronic excitation and free electrons follow `excitation_temperature` (S,) where it is
    given, and the populations of a component the `Departure` of that name in `departures`.
    """

    thickness: np.ndarray
    temperature: np.ndarray
    number_density: dict
    partition: dict
    excitation_temperature: np.ndarray | None = None
    departures: dict = field(default_factory=dict)

    @property
    def equilibrium(self):
        """Whether one temperature rules all populations, so that each layer's source is a black body."""
        return self.excitation_temperature is None and not self.departures

    @property
    def electron_temperature(self):
        """Temperature of the electrons and of the excitation (S,) [K]."""
        return self.temperature if self.excitation_temperature is None else self.excitation_temperature

    def total(self, names):
        """Number density of several species together (S,) [m-3], of those the path has."""
        return np.sum([self.number_density[name] for name in names if name in self.number_density], axis=0)

    def hwhm(self, lines, layer):
        """Lorentz half widths of a line list in a layer (L,) [m-1]."""
        return lorentz_hwhm(
            lines,
            self.temperature[layer],
            self.number_density["e-"][layer],
            self.total(NEUTRALS + TRACE_NEUTRALS)[layer],
            self.number_density[lines.species][layer],
            self.electron_temperature[layer],
        )

    def emission(self, lines, layer):
        """Emission of each line in a layer (L,) [W m-3 sr-1]."""
        species = (self.number_density[lines.species][layer], self.partition[lines.species][layer])
        temperature = self.temperature[layer]
        if self.excitation_temperature is None:
            population = boltzmann_population(
                lines.upper_energy, lines.upper_degeneracy, temperature, *species
            )
        else:
            population = two_temperature_population(
                lines.upper_energy,
                lines.upper_rotation,
                lines.upper_degeneracy,
                temperature,
                self.excitation_temperature[layer],
                *species,
            )
        if lines.component in self.departures:
            population = population * self.departures[lines.component].factors(lines, layer)[0]
        return line_emission(lines, population)

    def absorption_excess(self, lines, layer):
        """Absorption of each line over that of a black body at the excitation temperature, or None if 1."""
        departure = self.departures.get(lines.component)
        factors = (1.0, 1.0) if departure is None else departure.factors(lines, layer)
        if departure is None and (self.excitation_temperature is None or not lines.upper_rotation.any()):
            return None
        return absorption_excess(lines, self.temperature[layer], self.electron_temperature[layer], *factors)


class _Partition(dict):
    """Partition functions along a path (S,) by species, each computed when it is first asked for."""

    def __init__(self, temperature, excitation_temperature):
        super().__init__()
        self._temperature, self._excitation = temperature, excitation_temperature

    def __missing__(self, name):
        if self._excitation is None:
            self[name] = partition_function(name, self._temperature)
        else:
            pairs = zip(self._temperature, self._excitation, strict=True)
            self[name] = np.array([two_temperature_partition_function(name, *pair) for pair in pairs])
        return self[name]


def gas_path(path_distance, temperature, number_density, *, excitation_temperature=None, departures=None):
    """`GasPath` of layers of uniform gas from a sampled sight line.

    ASSUME: without the options, levels are populated at the gas temperature (local thermal equilibrium)
    whatever the densities.

    ValueError: unknown or missing species, negative or NaN density, temperature out of range, path not
    increasing.

    Parameters
    ----------
    path_distance : (S,) [m]
        Strictly increasing towards the observer.
    temperature : (S,) [K]
        200-15000 K.
    number_density : mapping species -> (S,) [m-3]
        All eleven species of air, and any of `species.TRACES`.
    excitation_temperature : (S,) [K], optional
        Of vibration, electronic excitation and free electrons, 200-15000 K; `temperature` is then that of
        translation and rotation.
    departures : mapping component -> Departure, optional
        Factors on populations.
    """
    thickness = layer_thickness(path_distance)
    temperature = within("temperature", temperature, *TEMPERATURE_RANGE, "K")
    unknown = set(number_density) - set(SPECIES + TRACES)
    missing = set(SPECIES) - set(number_density)
    if unknown or missing:
        raise ValueError(
            f"species of the path must be {', '.join(SPECIES)} (and may be {', '.join(TRACES)});"
            f" unknown: {', '.join(sorted(unknown)) or 'none'},"
            f" missing: {', '.join(sorted(missing)) or 'none'}"
        )
    density = {
        name: non_negative(f"number_density of {name}", number_density[name], "m-3")
        for name in SPECIES + TRACES
        if name in number_density
    }
    shaped = [("temperature", temperature), *density.items()]
    if excitation_temperature is not None:
        excitation_temperature = within(
            "excitation_temperature", excitation_temperature, *TEMPERATURE_RANGE, "K"
        )
        shaped.append(("excitation_temperature", excitation_temperature))
    for name, values in shaped:
        if values.shape != thickness.shape:
            raise ValueError(f"{name} must have the path's shape {thickness.shape}; got {values.shape}")
    partition = _Partition(temperature, excitation_temperature)
    return GasPath(thickness, temperature, density, partition, excitation_temperature, dict(departures or {}))


def nodes_path(temperature, number_density):
    """`GasPath` whose layers, of no length that matters, are gas at nodes of temperature (K,) [K]."""
    return gas_path(np.arange(temperature.size, dtype=float), temperature, number_density)


def incident_path(ray):
    """Layers of a ray of a 'surface_view', which counts from the surface, towards the surface."""
    distance = ray["ray_distance"].values[::-1]
    species = [str(name) for name in ray["species"].values]
    density = dict(zip(species, ray["ray_number_density"].values[:, ::-1], strict=True))
    return gas_path(distance[0] - distance, ray["ray_temperature"].values[::-1], density)


def thin_lines(path, lines):
    r"""Radiance of each line if nothing were absorbed, and what leaving a layer out could change.

    .. math:: L_l = \sum_s \Delta s\, \varepsilon_{l,s}, \qquad
              b_s = \Delta s \sum_l \varepsilon_{l,s}\, B(\tilde\nu_l, T_{max}) / B(\tilde\nu_l, T_s)

    The layer emits at most its share of L and absorbs at most :math:`\kappa\,\Delta s\,B(T_{max})` with
    :math:`\kappa = j/B(T_s)`, for no radiance on the path exceeds that of a black body at its highest
    temperature; :math:`b_s` bounds both.

    Source: Kirchhoff's law.

    Of a `GasPath` and a `LineList`: radiance by line (L,), emission by layer (S,), bound by layer (S,) [W m-2
    sr-1].
    """
    by_line = np.zeros(len(lines))
    by_layer, bound = np.zeros(len(path.thickness)), np.zeros(len(path.thickness))
    quantum = SECOND_RADIATION * lines.wavenumber
    hot = quantum / path.temperature.max()
    hottest = np.expm1(-hot)
    # new arrays would cost more than the arithmetic
    cold, excess = np.empty(len(lines)), np.empty(len(lines))
    for layer, thickness in enumerate(path.thickness):
        radiance = path.emission(lines, layer)
        radiance *= thickness
        # B(hot)/B(cold); cold stays below 120 in the allowed ranges, far from overflow.
        np.divide(quantum, path.temperature[layer], out=cold)
        np.exp(np.subtract(cold, hot, out=excess), out=excess)
        excess *= radiance
        excess *= np.expm1(np.negative(cold, out=cold), out=cold)
        excess /= hottest
        by_line += radiance
        by_layer[layer], bound[layer] = radiance.sum(), excess.sum()
    return by_line, by_layer, bound


def thin_continuum(path, wavelength, absorption):
    """Continuum radiance if nothing were absorbed (W,), and the bound of `thin_lines` by layer (S,).

    Wavelength (W,) [m] descends; absorption (S, components, W) [m-1].
    """
    depth = absorption.sum(axis=1) * path.thickness[:, None]
    radiance = (depth * blackbody_radiance(wavelength, path.electron_temperature[:, None])).sum(axis=0)
    hottest = blackbody_radiance(wavelength, path.electron_temperature.max())
    return radiance, -np.trapezoid(depth * hottest, wavelength, axis=-1)


def layers_that_matter(bound, allowance):
    """Which layers to keep so that the bounds of those left out add up to at most `allowance`."""
    order = np.argsort(bound, kind="stable")
    keep = np.empty(len(bound), dtype=bool)
    keep[order] = np.cumsum(bound[order]) > allowance
    return keep


def coldest_that_counts(temperature, emission):
    """Temperature [K] below which at most `UNRESOLVED_SHARE` of a system's emission arises."""
    order = np.argsort(temperature, kind="stable")
    share = np.cumsum(emission[order])
    return temperature[order][np.searchsorted(share, UNRESOLVED_SHARE * share[-1])]


class Continuum:
    """The continua of a path on a coarse axis, by component (4, W)."""

    def __init__(self, grid):
        self.axis = log_grid((grid.wavelength[-1], grid.wavelength[0]), min(CONTINUUM_POINTS, len(grid)))
        self.atoms = [bound_free(species, self.axis.wavenumber) for species in ("N", "O")]
        place = np.linspace(0, len(self.axis) - 1, len(grid))
        self.below = np.minimum(place.astype(int), len(self.axis) - 2)
        self.fraction = place - self.below

    def absorption(self, path, layer):
        """Absorption coefficients in a layer (4, W) [m-1], in the order of `CONTINUA`.

        ASSUME: away from equilibrium the continua follow the temperature of the electrons, and ions and
        electrons balance the excited atoms there (Saha): their source is a black body at that temperature.
        """
        axis, temperature = self.axis.wavenumber, path.electron_temperature[layer]
        density = {name: values[layer] for name, values in path.number_density.items()}
        electrons = density["e-"]
        ions = sum(density[name] for name in IONS + TRACE_IONS if name in density)
        neutral = electron_nitrogen_molecule_absorption(axis, temperature, electrons, density["N2"])
        for species in ("N", "O"):
            neutral += electron_atom_absorption(species, axis, temperature, electrons, density[species])
        recombination = sum(
            free_bound_absorption(
                atom, axis, temperature, density[atom.species], path.partition[atom.species][layer]
            )
            for atom in self.atoms
        )
        detachment = photodetachment_absorption(
            axis, temperature, electrons, density["O"], path.partition["O"][layer]
        )
        ionic = electron_ion_absorption(axis, temperature, electrons, ions)
        return np.array([ionic, neutral, recombination, detachment])

    def on_grid(self, values):
        """Coarse values (n, W) interpolated to the grid (n, G)."""
        result = np.empty((len(values), len(self.below)))
        for row, coarse, rise in zip(result, values, np.diff(values), strict=True):
            np.take(rise, self.below, out=row, mode="clip")  # 'clip': no copy; all lie within
            row *= self.fraction
            row += coarse.take(self.below)
        return result


@dataclass(frozen=True)
class PathRadiance:
    """Result on a grid: radiance by component (C, G), thin radiance and optical depth (G,)."""

    components: tuple
    radiance: np.ndarray
    thin_radiance: np.ndarray
    optical_depth: np.ndarray
    thin_lines: list
    thin_continuum: np.ndarray
    neglected_bound: float


def path_radiance(path, line_lists, grid):
    r"""Spectral radiance at the end of a path; nothing enters at its start.

    .. math:: j_\lambda = \tilde\nu \sum_l \varepsilon_l P(x - x_l) + \kappa_c B_\lambda, \qquad
              \kappa = j_\lambda / B_\lambda(T)

    per layer, then `transfer.cross_layer` from the first to the last. Away from equilibrium

    .. math:: \kappa = \left(\tilde\nu \sum_l \rho_l \varepsilon_l P(x - x_l) + \kappa_c B_\lambda\right)
              / B_\lambda(T_{ve})

    with the excess :math:`\rho` of `populations.absorption_excess`, 1 in equilibrium.

    Source: Fagnani et al., sec. 4.2; Kirchhoff's law for the absorption.
    ASSUME: within the profile of a line, emission over absorption varies as a black body.

    ValueError if the grid is too coarse for the Doppler widths of a system where it emits, or if a departure
    names no component.

    Parameters
    ----------
    path : GasPath
    line_lists : list of LineList
    grid : Grid

    Returns
    -------
    PathRadiance
        Components in the order of the line lists, then `CONTINUA`.
    """
    unknown = set(path.departures) - {lines.component for lines in line_lists}
    if unknown:
        raise ValueError(
            f"departures must name components among {', '.join(lines.component for lines in line_lists)};"
            f" got {', '.join(sorted(unknown))}"
        )
    spreaders = [prepare(lines, grid) for lines in line_lists]
    continuum = Continuum(grid)
    smooth = np.array([continuum.absorption(path, layer) for layer in range(len(path.thickness))])
    by_line, emission, bounds = zip(*(thin_lines(path, s.lines) for s in spreaders), strict=True)
    smooth_emission, smooth_bound = thin_continuum(path, continuum.axis.wavelength, smooth)
    bounds = np.array([*bounds, smooth_bound])
    thin_total = np.sum(emission) - np.trapezoid(smooth_emission, continuum.axis.wavelength)
    dark = -NEGLIGIBLE * np.trapezoid(blackbody_radiance(grid.wavelength, DARK_TEMPERATURE), grid.wavelength)
    allowance = max(NEGLIGIBLE / 2 * thin_total, dark)
    kept = np.array([layers_that_matter(bound, allowance / len(bounds)) for bound in bounds])
    bright = [
        (s.lines, e)
        for s, e, keep in zip(spreaders, emission, kept[:-1], strict=True)
        if keep.any() and e.sum() > RESOLVED_SHARE * thin_total
    ]
    require_resolution_of_light(path.temperature, bright, grid)
    if not path.equilibrium:  # the bounds hold for black-body sources
        kept = np.ones_like(kept)
    solution = _solve(path, spreaders, continuum, smooth, grid, kept)
    emerging = -np.trapezoid(solution[0].sum(axis=0), grid.wavelength)
    # In gas so opaque that little of its thin radiance emerges, the allowance was too generous.
    if bounds[~kept].sum() > max(NEGLIGIBLE * emerging, dark):
        kept = np.ones_like(kept)
        solution = _solve(path, spreaders, continuum, smooth, grid, kept)
    return PathRadiance(
        (*(lines.component for lines in line_lists), *CONTINUA),
        *solution,
        thin_lines=[(s.lines, values) for s, values in zip(spreaders, by_line, strict=True)],
        thin_continuum=smooth_emission,
        neglected_bound=float(bounds[~kept].sum()),
    )


def require_any_resolution(path, grid):
    """Refuse, without line lists, a grid too coarse even for the widest lines of a path that shines.

    ValueError: says how many points these need; narrower lines may need more.
    """
    hottest = path.temperature.max()
    if hottest > SHINES:
        require_resolution(
            grid, doppler_sigma(hottest, particle_mass("N")), f"the widest lines, at {hottest:.0f} K"
        )


def require_resolution_of_light(temperature, systems, grid):
    """Refuse a grid too coarse for the narrowest Doppler width of systems: (LineList, emission by layer)."""
    narrowest = []
    for lines, by_layer in systems:
        coldest = coldest_that_counts(temperature, by_layer)
        sigma = doppler_sigma(coldest, particle_mass(lines.species))
        narrowest.append((float(sigma), f"{lines.component} at {coldest:.0f} K"))
    if narrowest:
        require_resolution(grid, *min(narrowest))


def _solve(path, spreaders, continuum, smooth, grid, kept):
    """Radiance by component (C, G), thin radiance and depth (G,) from the kept parts of each layer."""
    radiance = np.zeros((len(spreaders) + len(CONTINUA), len(grid)))
    thin_radiance, optical_depth = np.zeros(len(grid)), np.zeros(len(grid))
    crossed, emitted = np.flatnonzero(kept.any(axis=0)), np.empty_like(radiance)
    for done, layer in enumerate(crossed, start=1):
        temperature, thickness = path.temperature[layer], path.thickness[layer]
        blackbody = blackbody_radiance(grid.wavelength, path.electron_temperature[layer])
        emitted[:], excess = 0.0, 0.0
        if kept[-1, layer]:
            np.multiply(continuum.on_grid(smooth[layer]), blackbody, out=emitted[len(spreaders) :])
        for index, spreader in enumerate(spreaders):
            if kept[index, layer]:
                lines = spreader.lines
                sigma = doppler_sigma(temperature, particle_mass(lines.species))
                emission, hwhm = path.emission(lines, layer), path.hwhm(lines, layer)
                np.multiply(grid.wavenumber, spread(spreader, emission, hwhm, sigma), out=emitted[index])
                absorbing = path.absorption_excess(lines, layer)
                if absorbing is not None:
                    surplus = spread(spreader, emission * (absorbing - 1), hwhm, sigma)
                    excess = excess + grid.wavenumber * surplus
        total = emitted.sum(axis=0)
        radiance, depth = cross_layer(radiance, emitted, (total + excess) / blackbody, thickness)
        thin_radiance += total * thickness
        optical_depth += depth
        step("layers", done, len(crossed))
    return radiance, thin_radiance, optical_depth
