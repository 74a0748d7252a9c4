"""Heat conduction by finite differences on a regular grid, 7-point stencil: the twin of a simple cubic crystal.

Cells are cubes; links between two materials take the harmonic mean of their conductivities; a wall temperature acts
half a cell from the centres. Nothing here is shared with the network.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve


class Grid(NamedTuple):
    """Cells under a load."""

    edge: float  # m
    k: np.ndarray  # (nx, ny, nz) float array, W/(m K)
    capacity: np.ndarray  # (nx, ny, nz) float array, J/K
    held: dict  # K: Temperatures of walls "x-", "x+", ...; other walls are insulated
    fluxes: dict  # W/m2: Into the body


def links(grid):
    """Conductance of the links along each axis, three arrays, one shorter than the grid along theirs, W/K."""
    found = []
    for axis in range(3):
        a, b = (np.delete(grid.k, end, axis=axis) for end in (-1, 0))
        found.append(2.0 / (1.0 / a + 1.0 / b) * grid.edge)
    return found


def wall_links(grid, name):
    """Conductance of the cells at a wall to it, W/K."""
    return 2.0 * _layer(grid.k, name) * grid.edge


def heat(grid, temperature):
    """Heat that each cell receives, (nx, ny, nz) float array, W."""
    received = np.zeros_like(temperature)
    for axis, conductance in enumerate(links(grid)):
        flow = conductance * np.diff(temperature, axis=axis)
        received += np.insert(flow, flow.shape[axis], 0.0, axis=axis) - np.insert(flow, 0, 0.0, axis=axis)
    for name, value in grid.held.items():
        _layer(received, name)[...] += wall_links(grid, name) * (value - _layer(temperature, name))
    for name, value in grid.fluxes.items():
        _layer(received, name)[...] += value * grid.edge**2
    return received


def explicit_step(grid, temperature, dt):
    """Temperatures after one explicit step."""
    return temperature + dt * heat(grid, temperature) / grid.capacity


def steady(grid):
    """Steady temperatures by sparse elimination, (nx, ny, nz) float array, K."""
    shape, number = grid.k.shape, np.arange(grid.k.size).reshape(grid.k.shape)
    diagonal, rows, columns, values = np.zeros(shape), [], [], []
    for axis, conductance in enumerate(links(grid)):
        a, b = (np.delete(number, end, axis=axis).ravel() for end in (-1, 0))
        rows += [a, b]
        columns += [b, a]
        values += [-conductance.ravel()] * 2
        np.add.at(diagonal.reshape(-1), a, conductance.ravel())
        np.add.at(diagonal.reshape(-1), b, conductance.ravel())
    for name in grid.held:
        _layer(diagonal, name)[...] += wall_links(grid, name)
    entries = (np.concatenate([*values, diagonal.ravel()]), (np.concatenate([*rows, number.ravel()]),
               np.concatenate([*columns, number.ravel()])))  # fmt: skip
    matrix = sparse.csr_matrix(entries, shape=(number.size,) * 2)
    return spsolve(matrix.tocsc(), heat(grid, np.zeros(shape)).ravel()).reshape(shape)


def _layer(array, name):
    """View of the cells at a wall."""
    where = [slice(None)] * 3
    where["xyz".index(name[0])] = 0 if name[1] == "-" else -1
    return array[tuple(where)]
