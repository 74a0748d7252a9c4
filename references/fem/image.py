"""Steady conduction in an image: each voxel is a trilinear hexahedron, or some equal ones.

The unknown is what the temperature differs by from a known part, the mean gradient or the walls' temperatures. Bricks
join where they share a node, so a heat path may lead over an edge or a corner. Pores, and bodies that no heat can pass,
are left out of the equations, see `components`.
"""

import math
import time
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from demheat.field import Field
from demheat.splitting import Splitting, by_splitting
from references.fem import components
from references.fem.bricks import Bricks, bricks, nodes_of, stiffness, wall_nodes
from references.fem.multigrid import solve_free
from references.fem.system import known_part

# Corners of a brick on its node with the least coordinates; of a wall's rectangle.
CORNERS = np.array([(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)])
# Of the sum of the parts: fluxes into a body that balance leave rounding only.
BALANCED = 1e-8
# What split bricks tell of the error: 16 drawn images ask for up to 3.9, of noise in pores, most for less than 2.
SPLIT = Splitting(32**3, 4.5)


class Wall(NamedTuple):
    """Rectangles of a wall, as `components` asks for them."""

    triangles: np.ndarray  # (m, 4) int array: Their nodes
    owners: np.ndarray  # (m,) int array: Bricks behind them


class Grid(NamedTuple):
    """Bricks of an image as a mesh."""

    axes: tuple  # three float arrays, m: Coordinates of the nodes
    points: np.ndarray  # (n, 3) float array, m
    cells: np.ndarray  # (m, 8) int array
    phase: np.ndarray  # (m,) int array
    pairs: np.ndarray  # (p, 2) int array: A node on an upper face of a periodic cell, and the one for which it stands
    walls: dict

    @property
    def shape(self):
        """Bricks along each axis."""
        return tuple(len(x) - 1 for x in self.axes)


@dataclass(frozen=True)
class Voxels(Bricks):
    """Nodal temperatures of an image."""

    conductivity: np.ndarray = None  # (a, b, c) float array, W/(m K): Of each brick; 0 where no heat passes
    lost: np.ndarray | None = None  # (a, b, c) bool array or None: Bricks of bodies that reach no temperature

    def conductivity_of(self, bricks):
        """Conductivity of bricks by their indices along each axis, (p,) float array, W/(m K)."""
        return self.conductivity[bricks]

    def temperature_at(self, points):
        """Temperature at (n, 3) points in metres, (n,) float array, K; of a periodic cell beyond it, too."""
        home, shift = points, 0.0
        if self.scene.periodic:
            home = points % self.scene.size
            shift = (points - home) @ np.array(self.scene.gradient)
        found = super().temperature_at(home) + shift
        return found if self.lost is None else np.where(self.lost[self._bricks(home)], np.nan, found)

    def flux_at(self, points):
        """Flux density at (n, 3) points in metres, (n, 3) float array, W/m2; on a face that of one side."""
        return super().flux_at(points % self.scene.size if self.scene.periodic else points)

    def mean_flux(self):
        """Flux density averaged over the volume, (3,) float array, W/m2."""
        nodal = self.temperature.reshape([len(x) for x in self.grid])
        widths, found = [np.diff(x) for x in self.grid], np.empty(3)
        for axis in range(3):
            rise = np.diff(nodal, axis=axis)
            for other in (a for a in range(3) if a != axis):
                ends = np.moveaxis(rise, other, 0)
                rise = np.moveaxis((ends[1:] + ends[:-1]) / 2, 0, other)
            areas = [w if a != axis else np.ones(len(w)) for a, w in enumerate(widths)]
            found[axis] = -np.einsum("ijk,ijk,i,j,k->", self.conductivity, rise, *areas) / self.scene.volume
        return found


def solved_image(scenes, size, tolerance) -> list[Field]:
    """The Field of an image under each of some loads, with one multigrid where all hold the same nodes."""
    for scene in scenes:
        scene.require("elements of an image know held temperatures and fluxes", takes=("image",))
    grid, kept = _grid(scenes[0], size), {}
    return [_solved(scene, grid, tolerance, kept) for scene in scenes]


def _grid(scene, size):
    axes, phase = bricks(scene, size)
    shape = tuple(len(x) for x in axes)
    numbers = np.arange(np.prod(shape)).reshape(shape)
    first = numbers[:-1, :-1, :-1].ravel()
    cells = first[:, None] + CORNERS @ np.array([shape[1] * shape[2], shape[2], 1])
    pairs = np.empty((0, 2), int)
    if scene.periodic:
        home = np.ix_(*(np.arange(n) % (n - 1) for n in shape))
        pairs = np.column_stack([numbers.ravel(), numbers[home].ravel()])
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    walls = {name: _wall(name, numbers, phase.shape) for name in scene.walls or {}}
    return Grid(axes, nodes_of(axes), cells, phase.ravel(), pairs, walls)


def _wall(name, numbers, counts):
    """Rectangles of a wall and the bricks behind them."""
    axis, end = "xyz".index(name[0]), 0 if name[1] == "-" else -1
    nodes = np.take(numbers, end, axis=axis)
    corners = [nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, :-1], nodes[1:, 1:]]
    owners = np.take(np.arange(np.prod(counts)).reshape(counts), end, axis=axis)
    return Wall(np.stack(corners, axis=-1).reshape(-1, 4), owners.ravel())


def _solved(scene, grid, tolerance, kept):
    """One load; `kept` is what loads share."""
    begun = time.perf_counter()
    conductivity, found = scene.conductivities[grid.phase], None
    if conductivity.min() == 0:
        found = components.find(scene, grid)
        conductivity = np.where(found.still, 0.0, conductivity)
    lift, level, nodes, shares = known_part(scene, grid)
    imposed = _imposed(scene, grid, scene.conductivities[grid.phase] > 0)
    correction, stats = np.zeros(len(lift)), {"unknowns": 0, "iterations": 0, "residual": 0.0}
    matrix = kept.get("matrix") if found is None else None
    if conductivity.any():
        if matrix is None:
            matrix = stiffness([np.diff(x) for x in grid.axes], conductivity.reshape(grid.shape))
            kept |= {"matrix": matrix, "free": None}
        loads = imposed - matrix @ lift, imposed
        correction, stats = _corrected(matrix, loads, shares > 0, grid, (tolerance, kept))
    temperature = lift + correction + level
    heat = np.zeros(len(lift)) if matrix is None else matrix @ (lift + correction) - imposed
    lost = None
    if found is not None:
        lost = _settled(found, scene, grid, temperature)
    stats |= {"elements": len(grid.cells), "nodes": len(grid.points), "size": _longest(grid)}
    stats |= {"islands": 0 if found is None else int(np.count_nonzero(~found.passing))}
    stats |= {"solve_s": time.perf_counter() - begun}
    view = Voxels(scene, grid.axes, grid.phase.reshape(grid.shape), temperature, conductivity.reshape(grid.shape), lost)
    return Field(
        scene=scene,
        mean_flux=view.mean_flux(),
        fractions=scene.image.fractions,
        sampler=view.samples,
        temperature_at=view.temperature_at,
        flux_at=view.flux_at,
        wall_temperature=_wall_temperatures(scene, grid, temperature),
        wall_heat=_wall_heat(scene, grid, heat, (nodes, shares)),
        stats=stats,
        estimator=partial(_estimated, tolerance=tolerance),
    )


def _estimated(field, tolerance):
    """Estimate of a field, by bricks split once more."""
    size, image = field.stats["size"], field.scene.image

    def again(scene, parts):
        return solved_image([scene], size / parts, tolerance)[0]

    bricks = field.stats["elements"] // math.prod(image.shape)
    return by_splitting(field, again, SPLIT._replace(most=max(SPLIT.most // bricks, 1)))


def _longest(grid):
    return float(max(np.diff(x).max() for x in grid.axes))


def _imposed(scene, grid, solid):
    """Heat of the fluxes of walls at each node, (n,) float array, W; only what conducts takes it."""
    heat = np.zeros(len(grid.points))
    for name, value in scene.wall_fluxes.items():
        weights = _weights(name, grid, solid)
        if not weights.any():
            raise ValueError(f"Scene.walls[{name!r}]: a Flux needs a wall that conducts somewhere")
        heat += value * weights
    return heat


def _weights(name, grid, solid):
    """Integrals of the shape functions over what conducts of a wall, (n,) float array, m2."""
    if solid.all():
        return wall_nodes(name, grid.axes).weights
    corners, owners = grid.walls[name]
    widths = [np.diff(x) for x in grid.axes]
    widths["xyz".index(name[0])] = np.ones(len(widths["xyz".index(name[0])]))
    areas = np.prod([w[i] for w, i in zip(widths, np.unravel_index(owners, grid.shape), strict=True)], axis=0)
    return np.bincount(corners.ravel(), np.repeat(areas * solid[owners] / 4, 4), len(grid.points))


def _corrected(matrix, loads, held, grid, how):
    """What the temperature differs by from the known part, and statistics; loads: all, and those of fluxes alone."""
    (tolerance, kept), (load, imposed) = how, loads
    home = np.arange(len(load))
    home[grid.pairs[:, 0]] = grid.pairs[:, 1]
    load = np.bincount(home, load, len(load))
    if kept.get("free") is None:
        kept["tied"] = _tied(matrix, home)
    fixed = _pinned(kept["tied"], held, imposed, grid.points)
    correction, stats = solve_free(grid, kept["tied"], load, fixed, home, tolerance, kept=kept)
    return correction[home], stats


def _tied(matrix, home) -> csr_matrix:
    """The same matrix where each node is the one for which it stands."""
    if np.array_equal(home, np.arange(len(home))):
        return matrix
    parts = matrix.tocoo()
    return coo_matrix((parts.data, (home[parts.row], home[parts.col])), shape=matrix.shape).tocsr()


def _pinned(matrix, held, imposed, points):
    """Nodes whose correction is zero: those of walls, and one of each body that no wall holds."""
    present = matrix.diagonal() > 0
    fixed = held.copy()
    count, label = connected_components(matrix, directed=False)
    tied = np.zeros(count, bool)
    tied[label[held & present]] = True
    heat, size = (np.bincount(label, part, count) for part in (imposed, np.abs(imposed)))
    first = np.full(count, len(label))
    np.minimum.at(first, label[present], np.flatnonzero(present))
    for body in np.flatnonzero(~tied & (first < len(label))):
        if abs(heat[body]) > BALANCED * size[body]:
            raise ValueError(
                f"Scene.walls: a flux enters a part, near {points[first[body]]}, that no temperature reaches"
            )
        fixed[first[body]] = True
    return fixed


def _settled(found, scene, grid, temperature):
    """Give bodies that no heat passes their temperature, in place; bricks that none reaches."""
    components.settle_still(found, scene, temperature)
    if not scene.periodic:
        return np.append(~found.passing & np.isnan(found.level), False)[found.element].reshape(grid.shape)
    gradient = np.array(scene.gradient)
    # Trilinear: the mean over a brick is that of its corners.
    rest = (temperature - grid.points @ gradient)[grid.cells].mean(axis=1)
    inside, bodies = found.element >= 0, len(found.passing)
    volume = np.prod(np.meshgrid(*map(np.diff, grid.axes), indexing="ij"), axis=0).ravel()[inside]
    mean = np.bincount(found.element[inside], volume * rest[inside], bodies)
    mean /= np.bincount(found.element[inside], volume, bodies)
    nodes = found.node >= 0
    temperature[nodes] -= mean[found.node[nodes]]
    return None


def _wall_temperatures(scene, grid, temperature):
    walls = scene.wall_temperatures
    for name in scene.wall_fluxes:
        weights = _weights(name, grid, scene.conductivities[grid.phase] > 0)
        walls[name] = float(weights @ temperature / weights.sum())
    return walls


def _wall_heat(scene, grid, heat, held):
    """Heat into the body through each loaded wall, W."""
    nodes, shares = held
    found = {name: float(np.sum(heat[own] / shares[own])) for name, own in nodes.items()}
    for name, value in scene.wall_fluxes.items():
        found[name] = float(value * _weights(name, grid, scene.conductivities[grid.phase] > 0).sum())
    return found
