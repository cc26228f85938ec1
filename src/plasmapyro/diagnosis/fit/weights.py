"""Noise of an instrument and what the channels of a bin share, as weights of least squares."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Noise:
    """Noise of one instrument on its bins: `variance` (n, C) inf where nothing was measured, and what the
    channels of a bin share, (n,) [1]: that of the brightness of the gas, `flicker`, of all light, `gain`; and
    `late` (n, C), what light changes by within the standard deviation of the time of a bin; of the `course`
    over wavelength, whose shapes are rows (m, C)."""

    variance: np.ndarray
    flicker: np.ndarray
    gain: np.ndarray | float = 0.0
    late: np.ndarray | float = 0.0
    course: np.ndarray | float = 0.0
    shapes: tuple | np.ndarray = ()


class Weigher:
    r"""Applies :math:`\Sigma^{-1}`, :math:`\Sigma = \mathrm{diag}(\sigma^2) + U U^T` per bin.

    The columns of U are what the channels of a bin share: the gas (n, C) times the root of its flicker, the
    value (n, C) times that of the gain, what a time that is uncertain does, and the value times each shape of
    the course, if there is any.

    Notes
    -----
    Source: Woodbury's formula.
    """

    def __init__(self, noise, gas, value=None):
        self.weight = 1 / noise.variance
        shared = [np.sqrt(noise.flicker)[:, None] * gas]
        if np.any(noise.gain):
            shared.append(np.sqrt(noise.gain)[:, None] * value)
        if np.any(noise.late):
            shared.append(noise.late)
        if np.any(noise.course):
            shared += [np.sqrt(noise.course)[:, None] * value * row for row in noise.shapes]
        shared = np.stack(shared, axis=1)
        self.shared = self.weight[:, None] * shared  # (n, r, C)
        size = self.shared @ shared.transpose(0, 2, 1)  # (n, r, r)
        self.core = np.linalg.inv(np.eye(len(size[0])) + size)
        self.scale = np.sqrt(self.weight)
        # (I + V V^T)^-1/2 = I - V Q (1 - 1/sqrt(1 + l)) / l Q^T V^T with V^T V = Q l Q^T, V = sigma^-1 U
        self.unit = self.shared / np.where(self.scale > 0, self.scale, 1.0)[:, None]
        value, vector = np.linalg.eigh(size)
        share = -np.expm1(-0.5 * np.log1p(np.maximum(value, 0.0))) / np.maximum(value, 1e-300)
        self.inner = (vector * share[:, None]) @ vector.transpose(0, 2, 1)

    def __call__(self, rows):
        """Rows (n, C) or (n, C, k) weighted."""
        if rows.ndim == 2:
            return self(rows[..., None])[..., 0]
        inner = self.core @ (self.shared @ rows)
        return self.weight[..., None] * rows - self.shared.transpose(0, 2, 1) @ inner

    def of(self, chosen):
        """The same for some of the bins (n,)."""
        part = object.__new__(Weigher)
        for name, values in vars(self).items():
            setattr(part, name, values[chosen])
        return part

    def root(self, rows):
        r"""Rows (n, C, k) times :math:`\Sigma^{-1/2}`, flattened to (n C, k); of residuals, chi-squared is
        then the sum of squares."""
        result = rows * self.scale[..., None]
        result -= self.unit.transpose(0, 2, 1) @ (self.inner @ (self.unit @ result))
        return flat(result)


def flat(rows):
    """Rows (n, C, k) as (n C, k), also for k = 0: bins that no column touches."""
    return rows.reshape(rows.shape[0] * rows.shape[1], rows.shape[2])
