"""Cubes, cube roots and other powers whose last bit is the same on every processor.

NumPy computes powers, roots, exponentials and logarithms of arrays, and of its own numbers, by other code where a
processor has AVX-512, and rounds otherwise there: every other cube root differs in its last bit. Spheres that collide
grow such a bit until they are other spheres. Here is what asks the C library instead, which looks at no such thing.
"""

import math

import numpy as np


def power(base, exponent) -> np.ndarray:
    """Elements of `base` to those of `exponent`; the same bits as NumPy's own without AVX-512."""
    # The one power of NumPy that has no other code for some processors: github.com/numpy/numpy/issues/25269.
    return np.float_power(base, exponent)


def cubed(values) -> np.ndarray:
    """The third power of each value."""
    return power(values, 3.0)


def exponential(values) -> np.ndarray:
    """The exponential of each value."""
    return np.array([math.exp(value) for value in values.tolist()])


def cube_root(value: float) -> float:
    """Cube root of a number."""
    try:
        return math.cbrt(value)
    except AttributeError:
        # Python 3.10 has none: another last bit there, and so other spheres than by 3.11.
        return math.copysign(math.pow(abs(value), 1 / 3), value)
