"""Numba kernel of the size of elements at a point, where many features ask for small ones: those near are looked up."""

import math

import numba

# A table is one array, for gmsh hands on one address: its length; cells along x, y, z; cells per length along x, y, z;
# where the starts of the cells' features and where the features begin; how much sizes grow with the distance.
HEAD = 10
# Centre x, y, z, radius and size of a feature; 1 if sizes grow to both sides of its surface, else 0.
WIDTH = 6


@numba.njit(cache=True)
def size_at(x, y, z, size, table):
    """Size of elements at a point of the box.

    x, y, z : float
    size : float; where no feature asks for less
    table : (n,) float array; as `references.mesh.sizes.table` makes it
    """
    cell = 0
    for axis in range(3):
        along = (x, y, z)[axis] * table[4 + axis]
        cell = cell * int(table[1 + axis]) + int(min(max(along, 0.0), table[1 + axis] - 1.0))
    starts, features = int(table[7]), int(table[8])
    for i in range(int(table[starts + cell]), int(table[starts + cell + 1])):
        row = features + WIDTH * i
        dx, dy, dz = x - table[row], y - table[row + 1], z - table[row + 2]
        beyond = math.sqrt(dx * dx + dy * dy + dz * dz) - table[row + 3]
        if beyond < 0.0:
            beyond = -beyond if table[row + 5] > 0.0 else 0.0
        size = min(size, table[row + 4] + table[9] * beyond)
    return size


@numba.cfunc("float64(int32, int32, float64, float64, float64, float64, voidptr)", cache=True)
def size_callback(dimension, tag, x, y, z, size, table):
    """`size_at` as gmsh calls it: dimension and tag of an entity, a point, the size so far, the table's address."""
    length = int(numba.carray(table, (1,), numba.float64)[0])
    return size_at(x, y, z, size, numba.carray(table, (length,), numba.float64))
