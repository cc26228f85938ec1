"""Line emission on the grid: populations, line strengths, and Voigt profiles by Fourier transform."""

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.sparse import csc_array, csr_array

from plasmapyro.checks import non_negative, positive
from plasmapyro.constants import LIGHT_SPEED, PLANCK, SECOND_RADIATION
from plasmapyro.radiation.grid import points_for
from plasmapyro.radiation.lines import LineList

SPLINE_DEGREE = 5  # of the B-spline that puts a line between grid points
PADDING = 0.15  # [1], of the grid; periodic images of lines stay at least half of it outside the grid
COARSENINGS = (1, 2, 4, 8, 16, 32)  # of the grid that places lines of great Lorentz width
COARSE_WIDTH = 6.0  # coarse grid steps in the least Lorentz width placed there; 1e-9 of the peak
BATCH = 8  # Fourier transforms taken together, as many as a processor's vector holds
FEW_LINES = 0.05  # [1], of the grid points; fewer are gathered by line, more by grid point
FAR_POINTS = 513  # of the axis on which far wings are smooth
FAR_BIN = 1e-3  # [1], of the logarithm of the wavenumber; lines are gathered so for their far wings
FAR_LEAST = 1e-3  # [1]; nearer by, the far correction keeps its value at this distance, to 1e-6
SMALLEST_SIGMA_STEPS = 1.0  # Doppler sigma in grid steps; a profile keeps 99.8 % of its Fourier content
NODE_SCALE = 3.0  # Doppler sigmas; Lorentz widths below are spaced evenly, above geometrically
NARROW_RANGE = 0.01  # of widths on that scale; two nodes then keep the core to 1e-5 and the wing to 1e-4
NODES_AT_LEAST, NODES_PER_RANGE = 4, 4.0  # keep core and wing to 1e-4 up to a width ratio of 1000


def boltzmann_population(energy, degeneracy, temperature, number_density, partition_function):
    r"""Number density of a level in equilibrium.

    .. math:: n_i = n\, \frac{g_i}{Q(T)}\, e^{-h c \tilde E_i / k T}

    Parameters
    ----------
    energy : array_like [m-1]
    degeneracy : array_like [1]
    temperature : float [K]
    number_density : float [m-3]
        Of the species.
    partition_function : float [1]
        Q, with the same zero of energy and the same nuclear-spin normalisation.

    Returns
    -------
    ndarray [m-3]

    Raises
    ------
    ValueError
        Temperature not > 0, density negative.

    Notes
    -----
    Source: Boltzmann distribution.
    """
    temperature = positive("temperature", temperature, "K")
    number_density = non_negative("number_density", number_density, "m-3")
    return number_density * degeneracy / partition_function * np.exp(-SECOND_RADIATION * energy / temperature)


def line_emission(lines, upper_population):
    r"""Power emitted in each line, per volume and solid angle, integrated over the line.

    .. math:: \varepsilon = \frac{h c \tilde\nu}{4 \pi} A\, n_u

    Parameters
    ----------
    lines : LineList
    upper_population : (L,) [m-3]
        Of the upper levels, whatever made them.

    Returns
    -------
    ndarray (L,) [W m-3 sr-1]

    Notes
    -----
    Source: definition of the Einstein coefficient; Laux et al. (2003), equation 2.
    """
    return PLANCK * LIGHT_SPEED / (4 * np.pi) * lines.wavenumber * lines.einstein_a * upper_population


@dataclass(frozen=True)
class Spreader:
    """A line list on one grid: B-spline weights (padded grid, lines), their frequencies, and far wings.

    `weights` and `deconvolution` hold one array for each of the first `COARSENINGS`.
    """

    lines: LineList
    step: float
    first: int
    points: int
    weights: tuple
    frequency: np.ndarray
    deconvolution: tuple
    far_gather: csr_array
    far_kernel: np.ndarray


def prepare(lines, grid):
    """Place a line list on a grid, once for all gas states.

    Lines outside the padded grid (half of `PADDING` on either side) reach in with their far wings.

    Parameters
    ----------
    lines : LineList
    grid : Grid

    Returns
    -------
    Spreader

    Raises
    ------
    ValueError
        If no line lies on the padded grid.

    Notes
    -----
    Source: van den Bekerom and Pannier (2021) for the grid; Lee and Greengard, SIAM Rev. 46 (2004) 443 and
    Essmann et al., J. Chem. Phys. 103 (1995) 8577 for spreading with B-splines and deconvolution.
    """
    coarsest = COARSENINGS[-1]
    length = coarsest * next_fast_len(int(np.ceil(len(grid) * (1 + PADDING) / coarsest)), real=True)
    first = (length - len(grid)) // 2
    place = np.log(lines.wavenumber / grid.wavenumber[0]) / grid.step + first
    inside = (place >= SPLINE_DEGREE) & (place <= length - 1 - SPLINE_DEGREE)
    if not inside.any():
        raise ValueError(
            f"no line of {lines.component} within {1 / grid.wavenumber[-1]:g}-{1 / grid.wavenumber[0]:g} m"
        )
    frequency = rfftfreq(length)
    few = len(lines) < FEW_LINES * length
    weights, deconvolution = [], []
    for factor in COARSENINGS if few else COARSENINGS[:1]:
        weights.append(
            _spline_weights(place / factor, inside, length // factor, csc_array if few else csr_array)
        )
        known = frequency[: length // factor // 2 + 1] * factor
        deconvolution.append(np.sinc(known) ** -(SPLINE_DEGREE + 1))
    far = _far_wings(np.log(lines.wavenumber), inside, np.log(grid.wavenumber), length * grid.step)
    return Spreader(lines, grid.step, first, len(grid), tuple(weights), frequency, tuple(deconvolution), *far)


def _spline_weights(place, inside, length, gather):
    """Weights (length, L) of the lines at their places on a periodic grid; none for those outside."""
    offset = (SPLINE_DEGREE + 1) / 2 - place[inside]
    start = np.ceil(-offset)
    values = _cardinal_spline(start + offset, SPLINE_DEGREE)
    rows = (start.astype(int) + np.arange(SPLINE_DEGREE + 1)[:, None]) % length
    columns = np.broadcast_to(np.flatnonzero(inside), rows.shape)
    return gather((values.ravel(), (rows.ravel(), columns.ravel())), shape=(length, len(place)))


def _far_wings(position, inside, axis, period):
    """Gathering of lines into bins (2 bins, L) and the kernel from bins to the far axis (F, 2 bins).

    Lines on the padded grid (first half of the bins) need the true wing minus the sum over their periodic
    images, the others (second half) the true wing.
    """
    low = position.min() - FAR_BIN
    count = int(np.ceil((position.max() - low) / FAR_BIN)) + 2
    place = (position - low) / FAR_BIN
    below = place.astype(int)
    row = below + np.where(inside, 0, count)
    column = np.arange(len(position))
    gather = csr_array(
        (
            np.concatenate([1 - (place - below), place - below]),
            (np.concatenate([row, row + 1]), np.concatenate([column, column])),
        ),
        shape=(2 * count, len(position)),
    )
    distance = np.linspace(axis[0], axis[-1], FAR_POINTS)[:, None] - (low + FAR_BIN * np.arange(count))
    distance = np.where(np.abs(distance) < FAR_LEAST, FAR_LEAST, distance)
    wing = 1 / (4 * np.pi * np.sinh(distance / 2) ** 2)
    # No line of the padded grid is a period away from the grid: bins there are empty in the first half.
    within = np.where(np.abs(distance) < period, distance, period / 2)
    images = np.pi / (period * np.sin(np.pi * within / period)) ** 2
    return gather, np.hstack([wing - images, wing])


def _cardinal_spline(fraction, degree):
    """Cardinal B-spline of `degree` (support 0..degree+1) at fraction + 0, 1, ..., degree: (degree+1, L)."""
    values = np.ones((1, len(fraction)))
    for k in range(1, degree + 1):
        place = fraction + np.arange(k + 1)[:, None]
        here = np.vstack([values, np.zeros_like(fraction)])
        before = np.vstack([np.zeros_like(fraction), values])
        values = (place * here + (k + 1 - place) * before) / k
    return values


def require_resolution(grid, sigma, what):
    """Refuse a grid on which a Doppler profile spans less than `SMALLEST_SIGMA_STEPS` steps.

    Raises
    ------
    ValueError
        Says how many points would do.
    """
    if sigma < SMALLEST_SIGMA_STEPS * grid.step:
        span = (grid.wavelength[-1], grid.wavelength[0])
        needed = points_for(span, float(sigma) / SMALLEST_SIGMA_STEPS)
        raise ValueError(
            f"grid points must be >= {needed} for {what} (Doppler sigma {float(sigma):.3g} of the wavenumber,"
            f" step {grid.step:.3g}); got {len(grid)}"
        )


def _width_nodes(width, sigma):
    """Chebyshev nodes of the Lorentz widths and each line's interpolation weights: (K,), (K, L)."""
    low, high = np.arcsinh(np.array([width.min(), width.max()]) / (NODE_SCALE * sigma))
    if high == low:
        return width[:1], np.ones((1, len(width)))
    count = 2 if high - low < NARROW_RANGE else int(np.ceil(NODES_AT_LEAST + NODES_PER_RANGE * (high - low)))
    angle = np.pi * (2 * np.arange(count) + 1) / (2 * count)
    nodes = (low + high) / 2 + (high - low) / 2 * np.cos(angle)
    distance = np.arcsinh(width / (NODE_SCALE * sigma)) - nodes[:, None]
    on_node = distance == 0
    hit = on_node.any()
    if hit:
        distance[on_node] = 1.0
    share = np.divide(((-1.0) ** np.arange(count) * np.sin(angle))[:, None], distance, out=distance)
    if hit:
        share = np.where(on_node.any(axis=0), on_node, share)
    share /= share.sum(axis=0)
    return NODE_SCALE * sigma * np.sinh(nodes), share


def spread(spreader, strength, hwhm, sigma):
    r"""Sum of Voigt profiles on the grid, per unit of the logarithm of the wavenumber.

    .. math:: P(x) = \sum_l \varepsilon_l \int_{-\infty}^{\infty} e^{2\pi i q (x - x_l)}
              e^{-2\pi^2\sigma^2 q^2 - 2\pi \delta_l |q|}\, dq, \qquad x = \ln\tilde\nu,\
              \delta_l = \gamma_l/\tilde\nu_l

    with far wings :math:`\delta_l / 4\pi \sinh^2 (x - x_l)/2`, those of a Lorentz profile in wavenumber.

    Lines enter the Fourier transform through B-splines, which are divided out; lines of different
    Lorentz width share a few transforms by interpolation between Chebyshev nodes of the width; great
    widths leave only low frequencies and take a coarser grid. No wing
    is cut; what the periodicity of the transform adds to the far wings is taken off on a coarse axis.

    Parameters
    ----------
    spreader : Spreader
    strength : (L,) [any]
        Of the spreader's lines, integrated over the line.
    hwhm : (L,) [m-1]
        Lorentz half widths.
    sigma : float [1]
        Relative Doppler standard deviation.

    Returns
    -------
    ndarray (G,) [strength]
        Integrates over all wavenumbers to the sum of the strengths.

    Notes
    -----
    Source: as `prepare`. In wavenumber the Voigt profile is :math:`P/\tilde\nu`.
    """
    relative = hwhm / spreader.lines.wavenumber
    nodes, share = _width_nodes(relative, sigma)
    steps = 2 * np.pi / spreader.step * spreader.frequency
    transform = np.zeros(len(steps), dtype=complex)
    coarse = np.searchsorted(
        np.array(COARSENINGS[1 : len(spreader.weights)]) * COARSE_WIDTH * spreader.step, nodes
    )
    for level in np.unique(coarse):
        weights, deconvolution = spreader.weights[level], spreader.deconvolution[level]
        here, known = np.flatnonzero(coarse == level), slice(len(deconvolution))
        total = np.zeros(len(deconvolution), dtype=complex)
        for first in range(0, len(here), BATCH):
            batch = here[first : first + BATCH]
            placed = np.array([weights @ (strength * part) for part in share[batch]])
            for node, part in zip(nodes[batch], rfft(placed), strict=True):
                part *= np.exp(-node * steps[known])
                total += part
        transform[known] += total * deconvolution
    transform *= np.exp(-((sigma * steps) ** 2) / 2)
    profile = irfft(transform, n=spreader.weights[0].shape[0])
    near = profile[spreader.first : spreader.first + spreader.points] / spreader.step
    # einsum, not @: the bytes must not depend on the number of BLAS threads.
    far = np.einsum("fb,b->f", spreader.far_kernel, spreader.far_gather @ (strength * relative))
    place = np.linspace(0, FAR_POINTS - 1, spreader.points)
    return near + np.interp(place, np.arange(FAR_POINTS), far)
