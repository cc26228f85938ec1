"""Derivatives of a pointwise function by all its inputs at once: forward mode of automatic differentiation.

Each number carries its slopes along the directions that it depends on, and only those: most intermediate
results of the flow's equations depend on a few of the twelve inputs. The same function takes plain arrays.

Source: Griewank and Walther, Evaluating Derivatives, 2nd ed. (SIAM 2008), section 3.1.
"""

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

# Of the result y of a function of a (and b) by each of them.
PARTIALS = {
    np.add: (lambda y, a, b: 1.0, lambda y, a, b: 1.0),
    np.subtract: (lambda y, a, b: 1.0, lambda y, a, b: -1.0),
    np.multiply: (lambda y, a, b: b, lambda y, a, b: a),
    np.true_divide: (lambda y, a, b: 1 / b, lambda y, a, b: -y / b),
    np.power: (lambda y, a, b: b * a ** (b - 1),),  # of a constant power
    np.negative: (lambda y, a: -1.0,),
    np.sqrt: (lambda y, a: 0.5 / y,),
    np.exp: (lambda y, a: y,),
}


class Graded(NDArrayOperatorsMixin):
    """An array and its slopes, {direction: array or number}; a direction that is missing has none."""

    def __init__(self, value, slopes):
        self.value, self.slopes = value, slopes

    @property
    def real(self):
        """The array alone, as `np.real` gives it."""
        return self.value

    def __array_ufunc__(self, function, method, *given):
        values = [one.value if isinstance(one, Graded) else one for one in given]
        value, slopes = function(*values), {}
        for one, partial in zip(given, PARTIALS[function], strict=False):
            if isinstance(one, Graded):
                factor = partial(value, *values)
                for direction, slope in one.slopes.items():
                    if not (isinstance(factor, float) and factor == 1.0):
                        slope = factor * slope
                    slopes[direction] = slopes[direction] + slope if direction in slopes else slope
        return Graded(value, slopes)


def gradient(function, inputs, seeds):
    """Slopes {direction: array} of each output of a pointwise function at its `inputs`.

    `seeds`: for each input {direction: its share}, a number or an array.
    """
    return [row.slopes for row in function([Graded(*pair) for pair in zip(inputs, seeds, strict=True)])]


def derivatives(function, inputs):
    """Derivatives (E, Q, outputs, inputs) of a pointwise function by each of its inputs (E, Q)."""
    slopes = gradient(function, inputs, [{index: 1.0} for index in range(len(inputs))])
    shape = np.shape(inputs[0])
    columns = ([np.broadcast_to(row.get(k, 0.0), shape) for row in slopes] for k in range(len(inputs)))
    return np.stack([np.stack(column, axis=-1) for column in columns], axis=-1)
