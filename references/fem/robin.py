"""Walls that exchange heat with surroundings, in finite elements: integrals over a wall by one quadrature for all.

Convection adds a mass matrix of the wall, h N_i N_j, to the stiffness and h T_a N_i to the load (consistent, as Robin's
condition is in any textbook); radiation is linearised at the points of the same quadrature (Newton).
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from demheat.scene import STEFAN_BOLTZMANN, Convection, Radiation
from references.fem.elements import at_points, matrix_of

# Of the quadrature: fourth powers of quadratic temperatures times shape functions are of degree ten, but smooth.
DEGREE = 8


class Surface(NamedTuple):
    """A wall's elements and their points of quadrature."""

    nodes: np.ndarray  # (t, k) int array
    values: np.ndarray  # (q, k) float array: Shape functions at the points
    areas: np.ndarray  # (t, q) float array, m2: Weights, which sum to the wall's area
    count: int  # Nodes of the whole mesh

    def at(self, temperature):
        """Nodal values (n,) at the points, (t, q) float array."""
        return temperature[self.nodes] @ self.values.T

    def load(self, density):
        """Integrals of a density times each shape function, (n,) float array."""
        return np.bincount(self.nodes.ravel(), ((self.areas * density) @ self.values).ravel(), self.count)

    def matrix(self, coefficient):
        """Integrals of a coefficient times products of two shape functions, (n, n) CSR matrix."""
        products = (self.values[:, :, None] * self.values[:, None, :]).reshape(len(self.values), -1)
        blocks = ((self.areas * coefficient) @ products).reshape(-1, *(self.nodes.shape[1],) * 2)
        return matrix_of(blocks, self.nodes, self.count)


def on_triangles(mesh, triangles) -> Surface:
    """`Surface` of triangles of a mesh."""
    return Surface(triangles.astype(np.int64), *at_points(mesh, triangles, DEGREE), len(mesh.points))


class RobinWalls:
    """All walls of a scene that exchange heat."""

    def __init__(self, walls, count):
        self.walls, self.count = walls, count
        self.radiates = any(isinstance(load, Radiation) for load, _ in walls.values())

    def stiffness(self) -> csr_matrix:
        """What convection adds to the stiffness, (n, n) CSR matrix, W/K."""
        total = csr_matrix((self.count, self.count))
        for load, surface in self.walls.values():
            if isinstance(load, Convection):
                total = total + surface.matrix(load.coefficient)
        return total

    def constant(self, outside, level):
        """What fluids bring in where the temperature is a level, (n,) float array, W."""
        total = np.zeros(self.count)
        for name, (load, surface) in self.walls.items():
            if isinstance(load, Convection):
                total += surface.load(load.coefficient * (outside[name] - level))
        return total

    def radiated(self, outside, temperature):
        """What radiation brings in, (n,) float array, W."""
        total = np.zeros(self.count)
        for name, (load, surface) in self.walls.items():
            if isinstance(load, Radiation):
                total += surface.load(_density(load, outside[name], surface.at(temperature)))
        return total

    def tangent(self, temperature) -> csr_matrix:
        """Minus the derivative of what radiation brings in, (n, n) CSR matrix, W/K."""
        total = csr_matrix((self.count, self.count))
        for load, surface in self.walls.values():
            if isinstance(load, Radiation):
                # Temperatures that overshoot below 0 K radiate nothing.
                warm = np.maximum(surface.at(temperature), 0.0)
                total = total + surface.matrix(4.0 * load.emissivity * STEFAN_BOLTZMANN * warm**3)
        return total

    def entering(self, outside, temperature) -> dict[str, float]:
        """Heat that comes in through each wall, W."""
        heat = {}
        for name, (load, surface) in self.walls.items():
            here = surface.at(temperature)
            if isinstance(load, Convection):
                density = load.coefficient * (outside[name] - here)
            else:
                density = _density(load, outside[name], here)
            heat[name] = float(np.sum(surface.areas * density))
        return heat


def _density(load, outside, here):
    return load.emissivity * STEFAN_BOLTZMANN * (outside**4 - np.maximum(here, 0.0) ** 4)
