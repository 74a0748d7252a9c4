"""An order of points in which near ones stand near each other: every part of it is a part of space."""

import numpy as np

# Morton keys take 21 bits per axis: more than any float coordinate of a packing needs to be near its neighbours.
MORTON_BITS = 21


def morton_order(centers, size):
    """Order of the points along a Morton (Z) curve, (n,) int array; the longest side has 2**21 steps."""
    steps = np.clip(centers / np.max(size), 0.0, 1.0) * ((1 << MORTON_BITS) - 1)
    x, y, z = (_spread_bits(column) for column in steps.astype(np.uint64).T)
    return np.argsort(x | (y << np.uint64(1)) | (z << np.uint64(2)), kind="stable")


def _spread_bits(bits):
    """Put two zero bits between the 21 low bits of each number."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
    return bits
