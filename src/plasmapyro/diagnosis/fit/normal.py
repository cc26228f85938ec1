"""Normal equations of least squares: dense columns, products of few, and patterns of single channels."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.diagnosis.fit.weights import flat

FEW_CHANNELS, FULL = 8, 0.4  # below so many, or if so many columns are not zero, bins are not told apart


def gram(columns, patterns, weighers, residuals, products=None):
    """Normal matrix and score of dense columns (n, C, k), of products, and of patterns, which come last.

    A pattern (instrument, row (n, C)) stands for one column per channel of that instrument. `products` holds
    per instrument (rows (n, C, r), shares (n, r, m)) for m more columns `rows @ shares`, cheap if r is small.
    """
    first = columns[0].shape[2]
    k = first + (0 if products is None else products[0][1].shape[2])
    sizes = [row.shape[1] for _, row in patterns]
    starts = k + np.concatenate([[0], np.cumsum(sizes)]).astype(int)
    matrix, vector = np.zeros((starts[-1], starts[-1])), np.zeros(starts[-1])
    for place, (column, weigher, residual) in enumerate(zip(columns, weighers, residuals, strict=True)):
        rows_of_products, fold = None, _unfolded
        if products is not None and column.shape[1] < FEW_CHANNELS:
            column = np.concatenate([column, np.matmul(*products[place])], axis=2)
        elif products is not None:
            # Each row of each bin is a column of its own until all bins are added up.
            rows_of_products, shares = products[place]
            fold = _Fold(first, shares.reshape(-1, shares.shape[2]))
        count = column.shape[2] + (0 if rows_of_products is None else len(fold.shares))
        weighted = weigher(residual)
        mine = [
            (slice(a, a + n), row)
            for a, n, (at, row) in zip(starts, sizes, patterns, strict=False)
            if at == place
        ]
        rows = np.array([row for _, row in mine]).reshape(len(mine), *residual.shape)
        square, score = np.zeros((count, count)), np.zeros(count)
        cross = np.zeros((count, len(mine), residual.shape[1]))
        along = np.zeros((len(residual), weigher.shared.shape[1], count))
        for chosen, live, part in _parts(column, rows_of_products):
            some = weigher.of(chosen)
            root = some.root(part)
            _add(root.T @ root, square, live)
            score[live] += flat(part).T @ weighted[chosen].ravel()
            if mine:
                along[chosen, :, live] = some.core @ (some.shared @ part)
                scaled = rows[:, chosen] * some.weight
                cross[live] += _along_bins(scaled, part)
        matrix[:k, :k] += fold(fold(square).T)
        vector[:k] += fold(score)
        along = fold(along)
        if mine:
            cross = fold(cross.reshape(count, -1).T).reshape(len(mine), residual.shape[1], k)
        for at, (block, row) in enumerate(mine):
            shared = weigher.shared * row[:, None]
            part = cross[at] - np.tensordot(shared, along, axes=((0, 1), (0, 1)))
            matrix[block, :k], matrix[:k, block] = part, part.T
            vector[block] = np.sum(row * weighted, axis=0)
            for other, second in mine:
                others = weigher.core @ (weigher.shared * second[:, None])
                both = -np.tensordot(shared, others, axes=((0, 1), (0, 1)))
                both[np.diag_indices_from(both)] += np.sum(row * second * weigher.weight, axis=0)
                matrix[block, other] = both
    return matrix, vector


def _along_bins(rows, columns):
    """Sums (l, m, C) over the bins of rows (m, n, C) times columns (n, C, l)."""
    if len(columns) == 1:
        return columns[0].T[:, None] * rows[:, 0]
    return np.matmul(rows.transpose(2, 0, 1), columns.transpose(1, 0, 2)).transpose(2, 1, 0)


@dataclass(frozen=True)
class _Fold:
    """Turns products (..., first + s) with rows of all bins into (..., first + m) by shares (s, m)."""

    first: int
    shares: np.ndarray

    def __call__(self, values):
        rows = values[..., self.first :]
        shape = (*values.shape[:-1], self.shares.shape[1])
        folded = (rows.reshape(-1, len(self.shares)) @ self.shares).reshape(shape)
        return np.concatenate([values[..., : self.first], folded], axis=-1)


def _unfolded(values):
    return values


def _parts(column, rows=None):
    """Bins (slices), the columns that are not zero in them, and these: one by one where most columns touch
    few bins or rows (n, C, r) follow that stand for themselves in each bin, else all at once."""
    live = np.any(column, axis=1)
    if rows is None and (column.shape[1] < FEW_CHANNELS or np.count_nonzero(live) >= FULL * live.size):
        yield slice(None), slice(None), column
        return
    for at, mask in enumerate(live):
        chosen, own = slice(at, at + 1), np.flatnonzero(mask)
        part = column[chosen][..., own]
        if rows is not None:
            count = rows.shape[2]
            part = np.concatenate([part, rows[chosen]], axis=2)
            own = np.concatenate([own, column.shape[2] + at * count + np.arange(count)])
        yield chosen, own, part


def _add(part, square, live):
    """Add to the rows and columns `live` of a square, by flat places: three times as fast as by `ix_`."""
    if isinstance(live, slice):
        square += part
    else:
        square.reshape(-1)[(live[:, None] * len(square) + live).ravel()] += part.ravel()


def own_patterns(instruments, values, gas_rows, gases):
    """Patterns of the base model: a relative error of each channel, its dark, and errors of its gas, at all
    times and before the injection.

    Returns
    -------
    list of (instrument, row (n, C)), as `gram` takes them
    """
    return [
        (place, row)
        for place, (instrument, value, one, gas) in enumerate(
            zip(instruments, values, gas_rows, gases, strict=True)
        )
        for sigma, row in zip(
            pattern_sigmas(instrument),
            (value, np.ones_like(value), one, gas * (instrument.time < 0)[:, None]),
            strict=True,
        )
        if sigma.any()
    ]


def pattern_sigmas(one):
    """Prior standard deviations (C,) of the patterns of an instrument: errors of scale, dark, gas."""
    return one.pattern, one.dark, one.gas_error, one.before_error


def prior_of_patterns(instruments):
    """Inverse variances of the patterns in the order of `own_patterns`."""
    parts = [sigma**-2.0 for instrument in instruments for sigma in pattern_sigmas(instrument) if sigma.any()]
    return np.concatenate(parts) if parts else np.zeros(0)
