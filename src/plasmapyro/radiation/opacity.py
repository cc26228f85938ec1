"""Line emission on the grid: populations, line strengths, and Voigt profiles by Fourier transform."""

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.sparse import csr_array

from plasmapyro.checks import non_negative, positive
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.radiation.grid import points_for
from plasmapyro.radiation.lines import LineList, once
from plasmapyro.radiation.sharp import (
    COARSENING,
    CROSSING,
    KAISER_POINTS,
    WINDOW,
    SharpLines,
    broad_share,
    kaiser,
    kaiser_transform,
    sharp_lines,
    sharp_part,
)

SPLINE_DEGREE = 5  # of the B-spline that puts a line between grid points
PADDING = 0.15  # [1], of the grid; periodic images of lines stay at least half of it outside the grid
FEW_LINES = 4.0  # [1], windows of sharp parts over the grid; more lines are cheaper by spreading alone
EQUAL_WIDTHS = 0.01  # [1]; where the widths of many lines differ by less, all take the middle one
BATCH = 2  # Fourier transforms taken together: a processor's vector holds them, the cache not many more
FAR_CELLS = 512  # of the axis on which far wings are smooth
FAR_BIN = 1e-3  # [1], of the logarithm of the wavenumber; strengths are gathered so for their far wings, and
# nearer by than that the far correction keeps its value at this distance, to 1e-6
FAR_SHARE = 2e-3  # [1], of the padded grid, the widest bin; periodic images lie half of `PADDING` off
SMALLEST_SIGMA_STEPS = 1.0  # Doppler sigma in grid steps; a profile keeps 99.8 % of its Fourier content
NODE_SCALE = 3.0  # Doppler sigmas; Lorentz widths below are spaced evenly, above geometrically
LEAST_SEPARATION = 1e-6  # [1], Doppler sigmas between two nodes; their difference keeps ten digits
NARROW_RANGE = 0.01  # of widths on that scale; two nodes then keep the core to 1e-5 and the wing to 1e-4
NODES_AT_LEAST, NODES_PER_RANGE = 4, 3.5  # keep core and wing to 1e-4 up to a width ratio of 1000


def boltzmann_population(energy, degeneracy, temperature, number_density, partition_function):
    r"""Number density of a level in equilibrium.

    .. math:: n_i = n\, \frac{g_i}{Q(T)}\, e^{-h c \tilde E_i / k T}

    Source: Boltzmann distribution.

    ValueError: temperature not > 0, density negative.

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
    """
    temperature = positive("temperature", temperature, "K")
    number_density = non_negative("number_density", number_density, "m-3")
    per_state = np.asarray(energy * (-SECOND_RADIATION / temperature))
    np.exp(per_state, out=per_state)
    per_state *= number_density / partition_function
    return degeneracy * per_state


def line_emission(lines, upper_population):
    r"""Power (L,) [W m-3 sr-1] emitted in each line, integrated over it, by upper levels (L,) [m-3].

    .. math:: \varepsilon = \frac{h c \tilde\nu}{4 \pi} A\, n_u

    Source: definition of the Einstein coefficient; Laux et al. (2003), equation 2.
    """
    return lines.power * upper_population


@dataclass(frozen=True)
class Spreader:
    """A line list on one grid: weights (P, lines), their frequencies, sharp parts, and far wings.

    B-splines place lines on the padded grid; where lines are few, Kaiser-Bessel kernels place them on a
    coarse one that takes their broad parts alone, and `sharp` holds the rest. `rate` (Q,) [1] is the angular
    frequency of the transforms, `deconvolution` (Q,) [1] what they are multiplied by for the kernels,
    `wavelength` (P,) [m] that of the points which take the lines, `blur` [1] the least width these resolve.
    Far wings: gathering into bins of the padded grid in coarse steps (B, C) and of the lines `outside` it
    (D, outside), and the kernel from all bins to the far axis (F, B + D), which holds every `far_cell`-th
    point of the grid.
    """

    lines: LineList
    first: int
    points: int
    length: int
    weights: csr_array
    rate: np.ndarray
    deconvolution: np.ndarray
    wavelength: np.ndarray
    blur: float
    sharp: SharpLines | None
    outside: np.ndarray
    far_inside: csr_array
    far_outside: csr_array
    far_kernel: np.ndarray
    far_cell: int


def prepare(lines, grid):
    """Place a line list on a grid, once for all gas states.

    Lines outside the padded grid (half of `PADDING` on either side) reach in with their far wings. ValueError
    if no line lies on the padded grid. Source: van den Bekerom and Pannier (2021) for the grid; Lee and
    Greengard, SIAM Rev. 46 (2004) 443 and Essmann et al., J. Chem. Phys. 103 (1995) 8577 for spreading with
    B-splines and deconvolution.
    """
    length = COARSENING * next_fast_len(int(np.ceil(len(grid) * (1 + PADDING) / COARSENING)), real=True)
    first = (length - len(grid)) // 2
    position = np.log(lines.wavenumber / grid.wavenumber[0])
    place = position / grid.step + first
    inside = (place >= 0) & (place <= length - 1)
    if not inside.any():
        raise ValueError(
            f"no line of {lines.component} within {1 / grid.wavenumber[-1]:g}-{1 / grid.wavenumber[0]:g} m"
        )
    few = np.count_nonzero(inside) * WINDOW <= FEW_LINES * length
    factor = COARSENING if few else 1
    phase = 2 * np.pi * rfftfreq(length // factor)  # angular frequency times step of the grid that takes them
    if few:
        weights = _grid_weights(place / factor, inside, length // factor, KAISER_POINTS, kaiser)
        deconvolution = broad_share(phase) / kaiser_transform(phase)
    else:
        weights = _grid_weights(place, inside, length, SPLINE_DEGREE + 1, _cardinal_spline)
        deconvolution = np.sinc(phase / (2 * np.pi)) ** -(SPLINE_DEGREE + 1)
    padded = (np.arange(0, length, factor) - first) * grid.step
    cells = padded.reshape(-1, COARSENING // factor).mean(axis=1)
    return Spreader(
        lines,
        first,
        len(grid),
        length,
        weights,
        phase / (factor * grid.step),
        deconvolution / grid.step,
        np.exp(-padded) / grid.wavenumber[0],
        factor * grid.step / (CROSSING * np.pi) if few else 0.0,
        sharp_lines(place - first, len(grid), grid.step) if few else None,
        np.flatnonzero(~inside),
        *_far_wings(position[~inside], cells, length * grid.step, grid),
    )


def _grid_weights(place, inside, length, width, kernel):
    """Weights (length, L) of the lines at their places on a periodic grid; none for those outside.

    `kernel` gives its values at its first `width` points, at a fraction of a step from its edge and on.
    """
    start = np.ceil(place[inside] - width / 2)
    values = kernel(start - place[inside] + width / 2)
    rows = (start.astype(int) + np.arange(width)[:, None]) % length
    columns = np.broadcast_to(np.flatnonzero(inside), rows.shape)
    return csr_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(length, len(place)))


def _far_wings(outside, cells, period, grid):
    """Gathering of the padded grid and of the lines outside it, kernel and cell, as in `Spreader`.

    Lines on the padded grid need the true wing minus the sum over their periodic images, the others the
    true wing. `cells`: where `COARSENING` points of the padded grid have their middle; all from the grid's
    first point.
    """
    cell = -(-len(grid) // FAR_CELLS)
    axis = grid.step * cell * np.arange(-(-len(grid) // cell) + 1)
    width = min(FAR_BIN, FAR_SHARE * period)
    gather_inside, bins = _far_bins(cells, width)
    distance = _far_distance(axis, bins, width)
    # The far axis lies on the grid: no bin is a period away from it.
    images = np.pi / (period * np.sin(np.pi * distance / period)) ** 2
    kernel = _far_wing(distance) - images
    gather_outside, bins = _far_bins(outside, width)
    kernel = np.hstack([kernel, _far_wing(_far_distance(axis, bins, width))])
    return gather_inside, gather_outside, kernel, cell


def _far_wing(distance):
    return 1 / (4 * np.pi * np.sinh(distance / 2) ** 2)


def _far_distance(axis, bins, least):
    distance = axis[:, None] - bins
    return np.where(np.abs(distance) < least, least, distance)


def _far_bins(position, width):
    """Gathering of positions into bins, linearly (bins, P), and the places of the bins that take any."""
    if not len(position):
        return csr_array((0, 0)), np.zeros(0)
    place = (position - position.min()) / width
    below, column = place.astype(int), np.arange(len(position))
    share = np.concatenate([1 - (place - below), place - below])
    bins, row = np.unique(np.concatenate([below, below + 1]), return_inverse=True)
    gather = csr_array((share, (row, np.tile(column, 2))), shape=(len(bins), len(position)))
    return gather, position.min() + width * bins


def _cardinal_spline(fraction):
    """Cardinal B-spline (support 0..degree+1) at fraction + 0, 1, ..., degree: (degree+1, L)."""
    values = np.ones((1, len(fraction)))
    for k in range(1, SPLINE_DEGREE + 1):
        place = fraction + np.arange(k + 1)[:, None]
        here = np.vstack([values, np.zeros_like(fraction)])
        before = np.vstack([np.zeros_like(fraction), values])
        values = (place * here + (k + 1 - place) * before) / k
    return values


def require_resolution(grid, sigma, what):
    """Refuse a grid on which a Doppler profile spans less than `SMALLEST_SIGMA_STEPS` steps.

    ValueError: says how many points would do.
    """
    if sigma < SMALLEST_SIGMA_STEPS * grid.step:
        span = (grid.wavelength[-1], grid.wavelength[0])
        needed = points_for(span, float(sigma) / SMALLEST_SIGMA_STEPS)
        raise ValueError(
            f"grid points must be >= {needed} for {what} (Doppler sigma {float(sigma):.3g} of the wavenumber,"
            f" step {grid.step:.3g}); got {len(grid)}"
        )


def _width_nodes(width, scale):
    """Chebyshev nodes of the Lorentz widths and each width's interpolation weights: (K,), (K, L)."""
    low, high = _on_width_scale((width.min(), width.max()), scale)
    count = int(np.ceil(NODES_AT_LEAST + NODES_PER_RANGE * (high - low)))
    angle = np.pi * (2 * np.arange(count) + 1) / (2 * count)
    nodes = (low + high) / 2 + (high - low) / 2 * np.cos(angle)
    distance = _on_width_scale(width, scale) - nodes[:, None]
    on_node = distance == 0
    hit = on_node.any()
    if hit:
        distance[on_node] = 1.0
    share = np.divide(((-1.0) ** np.arange(count) * np.sin(angle))[:, None], distance, out=distance)
    if hit:
        share = np.where(on_node.any(axis=0), on_node, share)
    share /= share.sum(axis=0)
    return scale * np.sinh(nodes), share


def _on_width_scale(width, scale):
    """Lorentz widths on the scale of the nodes."""
    return np.arcsinh(np.asarray(width) / scale)


def _narrow_transform(spreader, placed, widths, common, sigma):
    """Transform of lines whose widths lie close together (Q,), times the factor `common` to all.

    Between two nodes the decay is linear in the width, so strength and strength times width suffice: the
    rows of `placed` (2, P), which is overwritten.
    """
    low, high = widths
    half = max((high - low) / np.sqrt(8), LEAST_SEPARATION * sigma)  # Chebyshev nodes of the range
    lower, upper = (low + high) / 2 - half, (low + high) / 2 + half
    transform, by_width = rfft(placed, overwrite_x=True)
    decay, slope = -lower * spreader.rate, -upper * spreader.rate
    np.exp(decay, out=decay)
    np.exp(slope, out=slope)
    slope -= decay
    slope *= common / (upper - lower)
    decay *= common
    by_width *= slope
    slope *= lower
    decay -= slope
    transform *= decay
    transform += by_width
    return transform


def _wide_transform(spreader, strength, relative, common, scale, placed=None):
    """Transform of lines of any widths (Q,), times the factor `common` to all.

    `relative` are the widths of the lines, or those at the points of the grid if the strengths are `placed`.
    """
    nodes, share = _width_nodes(relative, scale)
    transform = np.zeros(len(spreader.rate), dtype=complex)
    decay = np.empty(len(spreader.rate))
    for first in range(0, len(nodes), BATCH):
        batch = slice(first, first + BATCH)
        if placed is None:
            parts = np.array([spreader.weights @ (strength * weight) for weight in share[batch]])
        else:
            parts = share[batch] * placed
        for node, part in zip(nodes[batch], rfft(parts), strict=True):
            part *= np.exp(np.multiply(spreader.rate, -node, out=decay), out=decay)
            transform += part
    transform *= common
    return transform


def spread(spreader, strength, hwhm, sigma):
    r"""Sum of Voigt profiles on the grid, per unit of the logarithm of the wavenumber.

    .. math:: P(x) = \sum_l \varepsilon_l \int_{-\infty}^{\infty} e^{2\pi i q (x - x_l)}
              e^{-2\pi^2\sigma^2 q^2 - 2\pi \delta_l |q|}\, dq, \qquad x = \ln\tilde\nu,\
              \delta_l = \gamma_l/\tilde\nu_l

    with far wings :math:`\delta_l / 4\pi \sinh^2 (x - x_l)/2`, those of a Lorentz profile in wavenumber.

    Lines enter the Fourier transform through B-splines, which are divided out; lines of different
    Lorentz width share a few transforms by interpolation between Chebyshev nodes of the width. Where all
    lines have one width in wavenumber, as in a band, the relative width is taken from the place on the grid.
    Few lines take a coarse grid for the low frequencies, and the exact transform of each for the high ones,
    which fade within a short window. No wing is cut; what the periodicity of the transform adds to the far
    wings is taken off on a coarse axis.

    Source: as `prepare`. In wavenumber the Voigt profile is :math:`P/\tilde\nu`.

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
    """
    distinct = once(hwhm)
    low, high = distinct.min(), distinct.max()
    alike = high - low <= EQUAL_WIDTHS * high
    few = spreader.sharp is not None
    widths = hwhm / spreader.lines.wavenumber if few or not alike else None
    # Strength, and strength times relative width; of many lines with one width that follows the place on the
    # grid, to the few steps that a B-spline covers.
    placed = np.empty((2, len(spreader.wavelength)))
    placed[0] = spreader.weights @ strength
    if alike:
        relative = (low + high) / 2 * spreader.wavelength
        np.multiply(placed[0], relative, out=placed[1])
    else:
        relative = widths
        placed[1] = spreader.weights @ (strength * relative)
    total = _far_correction(spreader, placed[1], strength, hwhm)
    common = np.square(spreader.rate)
    common *= -(sigma**2) / 2
    np.exp(common, out=common)
    common *= spreader.deconvolution
    ends, scale = (relative.min(), relative.max()), NODE_SCALE * np.hypot(sigma, spreader.blur)
    if np.ptp(_on_width_scale(ends, scale)) < NARROW_RANGE:
        transform = _narrow_transform(spreader, placed, ends, common, sigma)
    else:
        transform = _wide_transform(spreader, strength, relative, common, scale, placed[0] if alike else None)
    profile = irfft(transform, n=spreader.length, overwrite_x=True)
    total += profile[spreader.first : spreader.first + spreader.points]
    if few:
        total += sharp_part(spreader.sharp, strength, widths, sigma)
    return total


def _far_correction(spreader, moment, strength, hwhm):
    """What the far wings lack on the grid (G,), from strength times relative width on the padded grid."""
    cells = np.einsum("cp->c", moment.reshape(spreader.far_inside.shape[1], -1))
    bins, outside = spreader.far_inside @ cells, spreader.outside
    if len(outside):
        product = strength[outside] * hwhm[outside] / spreader.lines.wavenumber[outside]
        bins = np.concatenate([bins, spreader.far_outside @ product])
    # einsum, not @: the bytes must not depend on the number of BLAS threads.
    far = np.einsum("fb,b->f", spreader.far_kernel, bins)
    fine = far[:-1, None] + np.diff(far)[:, None] * (np.arange(spreader.far_cell) / spreader.far_cell)
    return fine.ravel()[: spreader.points]
