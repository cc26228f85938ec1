"""Normal equations of least squares: dense columns, products of few, and patterns of single channels."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from plasmapyro.diagnosis.fit.weights import flat

FEW_CHANNELS, FULL = 8, 0.4  # below so many, or if so many columns are not zero, bins are not told apart


def gram(columns, patterns, weighers, residuals, products=None):
    """Normal matrix and score of dense columns (n, C, k), of products, and of patterns, which come last.

    A pattern (instrument, row (n, C)) stands for one column per channel of that instrument. `products` holds
    per instrument (rows (n, C, r), shares (n, r, m)) for m more columns `rows @ shares`, cheap if r is small.
    """
    k = columns[0].shape[2] + (0 if products is None else products[0][1].shape[2])
    sizes = [row.shape[1] for _, row in patterns]
    starts = k + np.concatenate([[0], np.cumsum(sizes)]).astype(int)
    matrix, vector = np.zeros((starts[-1], starts[-1])), np.zeros(starts[-1])
    for place, (column, weigher, residual) in enumerate(zip(columns, weighers, residuals, strict=True)):
        if products is not None and column.shape[1] < FEW_CHANNELS:
            column = np.concatenate([column, np.matmul(*products[place])], axis=2)
        whole = products is None or column.shape[1] < FEW_CHANNELS
        singles = _Singles.none(column.shape[1]) if whole else _Singles.of(*products[place])
        weighted = weigher(residual)
        matrix[:k, :k] += singles.fold(singles.fold(_square(column, singles, weigher)).T)
        score = flat(column).T @ weighted.ravel()
        vector[:k] += singles.fold(np.append(score, np.sum(singles.row * weighted[singles.bin], axis=1)))
        mine = [
            (slice(a, a + n), row)
            for a, n, (at, row) in zip(starts, sizes, patterns, strict=False)
            if at == place
        ]
        if not mine:
            continue
        scaled = np.stack([row * weigher.weight for _, row in mine])
        cross = singles.fold(_along_bins(scaled, column, singles))
        along = singles.fold(_shared_by(weigher, column, singles))
        cored = [weigher.core @ (weigher.shared * row[:, None]) for _, row in mine]
        for at, (block, row) in enumerate(mine):
            shared = weigher.shared * row[:, None]
            part = cross[:, at] - np.tensordot(along, shared, axes=((1, 2), (0, 1)))
            matrix[:k, block], matrix[block, :k] = part, part.T
            vector[block] = np.sum(row * weighted, axis=0)
            for (other, second), there in zip(mine[: at + 1], cored, strict=False):
                both = -np.tensordot(shared, there, axes=((0, 1), (0, 1)))
                both[np.diag_indices_from(both)] += np.sum(row * second * weigher.weight, axis=0)
                matrix[block, other], matrix[other, block] = both, both.T
    return matrix, vector


def score(columns, patterns, weighers, residuals):
    """The score of `gram` alone, of dense columns and patterns."""
    weighted = [weigher(residual) for weigher, residual in zip(weighers, residuals, strict=True)]
    dense = sum(flat(column).T @ one.ravel() for column, one in zip(columns, weighted, strict=True))
    return np.concatenate([dense, *(np.sum(row * weighted[place], axis=0) for place, row in patterns)])


@dataclass(frozen=True)
class _Singles:
    """Columns of products that live in one bin each, until all bins are added up: `row` (s, C) in `bin` (s,),
    and the sparse `shares` (m, s) that make them up to the columns asked for."""

    row: np.ndarray
    bin: np.ndarray
    shares: csr_array

    @classmethod
    def of(cls, rows, shares):
        count, channels, each = rows.shape
        singles = rows.transpose(0, 2, 1).reshape(-1, channels)
        sparse = csr_array(shares.reshape(len(singles), shares.shape[2]).T)
        return cls(singles, np.repeat(np.arange(count), each), sparse)

    @classmethod
    def none(cls, channels):
        return cls.of(np.zeros((0, channels, 0)), np.zeros((0, 0, 0)))

    def fold(self, values):
        """Values (first + s, ...) of dense columns and singles as those of the columns (first + m, ...)."""
        first = len(values) - len(self.bin)
        folded = self.shares @ values[first:].reshape(len(self.bin), int(np.prod(values.shape[1:])))
        return np.concatenate([values[:first], folded.reshape(len(folded), *values.shape[1:])])


def _square(column, singles, weigher):
    """Weighted products (first + s, first + s) of columns (n, C, first) and singles with one another: bin by
    bin, unless most columns touch most bins."""
    live = np.any(column, axis=1)
    few = column.shape[1] < FEW_CHANNELS or np.count_nonzero(live) >= FULL * live.size
    if few and not len(singles.row):
        root = weigher.root(column)
        return root.T @ root
    size = column.shape[2] + len(singles.row)
    square = np.zeros((size, size))
    for at, mask in enumerate(live):
        own, single = np.flatnonzero(mask), np.flatnonzero(singles.bin == at)
        part = np.concatenate([column[at][:, own], singles.row[single].T], axis=1)
        root = weigher.of(slice(at, at + 1)).root(part[None])
        places = np.append(own, column.shape[2] + single)
        # By flat places: three times as fast as by `ix_`.
        square.reshape(-1)[(places[:, None] * size + places).ravel()] += (root.T @ root).ravel()
    return square


def _along_bins(rows, column, singles):
    """Sums (first + s, p, C) over the bins of columns (n, C, first) and singles times rows (p, n, C)."""
    dense = np.matmul(rows.transpose(2, 0, 1).copy(), column.transpose(1, 0, 2))
    return np.concatenate([dense.T, rows[:, singles.bin].transpose(1, 0, 2) * singles.row[:, None]])


def _shared_by(weigher, column, singles):
    """What the channels of a bin share, in columns (n, C, first) and singles: (first + s, n, r)."""
    dense = weigher.core @ (weigher.shared @ column)
    alone = np.zeros((len(singles.bin), *dense.shape[:2]))
    own = weigher.core[singles.bin] @ (weigher.shared[singles.bin] @ singles.row[..., None])
    alone[np.arange(len(alone)), singles.bin] = own[..., 0]
    return np.concatenate([dense.transpose(2, 0, 1), alone])


def own_patterns(instruments, values, gas_rows):
    """Patterns of the base model: a relative error of each channel, its dark, and errors of its gas, at all
    times and before the injection.

    Returns
    -------
    list of (instrument, row (n, C)), as `gram` takes them
    """
    return [
        (place, row)
        for place, (instrument, value, of_gas) in enumerate(zip(instruments, values, gas_rows, strict=True))
        for sigma, row in zip(pattern_sigmas(instrument), (value, np.ones_like(value), *of_gas), strict=True)
        if sigma.any()
    ]


def pattern_sigmas(one):
    """Prior standard deviations (C,) of the patterns of an instrument: errors of scale, dark, gas."""
    return one.pattern, one.dark, one.gas_error, one.before_error


def places_of_patterns(instruments, size):
    """Where patterns stand among `size` numbers of which they are the last: {kind: slice} per instrument."""
    kinds, found = ("scale", "dark", "gas", "before"), []
    for one in instruments:
        free = [kind for kind, sigma in zip(kinds, pattern_sigmas(one), strict=True) if sigma.any()]
        found.append(dict.fromkeys(free, one.channels))
    place = size - sum(sum(own.values()) for own in found)
    for own in found:
        for kind, channels in own.items():
            own[kind] = slice(place, place + channels)
            place += channels
    return found


def prior_of_patterns(instruments):
    """Inverse variances of the patterns in the order of `own_patterns`."""
    parts = [sigma**-2.0 for instrument in instruments for sigma in pattern_sigmas(instrument) if sigma.any()]
    return np.concatenate(parts) if parts else np.zeros(0)
