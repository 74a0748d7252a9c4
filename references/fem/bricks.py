"""Structured hexahedra: a grid of bricks with trilinear temperatures, assembled diagonal by diagonal."""

import math
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np
from scipy.sparse import csr_matrix, dia_matrix

from demheat.field import Samples
from demheat.runtime.limits import check_memory
from demheat.scene import WALLS, Layer, Scene
from demheat.scene.inputs import finite
from references.fem.robin import Surface
from references.fem.separable import MASS, STIFFNESS, separable
from references.fem.space import Space, WallNodes, capacities

# Cube root of the box volume over the default edge.
EDGES = 32
MOST_CELLS = 2_000_000
# Coordinates of layers closer than this, of the box, are one plane.
SAME = 1e-10
# Least bytes of an image's brick: rows of a matrix and of its multigrid.
BYTES = 1000
# Points of a moving source per edge.
RESOLVE = 6
CORNERS = tuple(product((0, 1), repeat=3))
# Points of quadrature along an edge of a face.
FACE = 3
GAUSS = 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3)


@dataclass(frozen=True)
class Bricks:
    """Nodal temperatures (n,) of a scene on a grid."""

    scene: Scene
    grid: tuple  # three float arrays, m: Coordinates of the nodes along each axis
    phase: np.ndarray  # (a, b, c) int array: Of each brick
    temperature: np.ndarray  # (n,) float array, K: The last axis runs fastest

    def temperature_at(self, points):
        """Temperature at (n, 3) points in metres, (n,) float array."""
        nodes, local, _ = self._local(points)
        return np.einsum("cp,cp->p", self.temperature[nodes], _shares(local))

    def flux_at(self, points):
        """Flux density at (n, 3) points in metres, (n, 3) float array, W/m2; on a face that of one side."""
        nodes, local, widths = self._local(points)
        gradient = np.einsum("cp,cpx->px", self.temperature[nodes], _slopes(local, widths))
        return -self.conductivity_of(self._bricks(points))[:, None] * gradient

    def conductivity_of(self, bricks):
        """Conductivity of bricks by their indices along each axis, (p,) float array, W/(m K)."""
        return self.scene.conductivities[self.phase[bricks]]

    def spread(self, points, amounts):
        """Share amounts at points among the nodes by their shape functions."""
        nodes, local, _ = self._local(points)
        return np.bincount(nodes.ravel(), (_shares(local) * amounts).ravel(), len(self.temperature))

    def samples(self):
        """`Samples` at the eight Gauss points of each brick."""
        axes = [(x[:-1, None] + np.diff(x)[:, None] * GAUSS).ravel() for x in self.grid]
        widths = [np.repeat(np.diff(x), 2) / 2 for x in self.grid]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        phase = self.phase[self._bricks(points)]
        return Samples(points, outer(*widths).ravel(), self.temperature_at(points), phase, self.flux_at(points))

    def mean_flux(self):
        """Flux density averaged over the volume, (3,) float array, W/m2."""
        samples = self.samples()
        return samples.volumes @ samples.flux / self.scene.volume

    def _bricks(self, points):
        """Index of the brick of each point along each axis."""
        return tuple(
            np.clip(np.searchsorted(x, points[:, axis], "right") - 1, 0, len(x) - 2) for axis, x in enumerate(self.grid)
        )

    def _local(self, points):
        """Nodes (8, p) around points, local coordinates (3, p) and widths (3, p) in m of their bricks."""
        bricks, shape = self._bricks(points), [len(x) for x in self.grid]
        low = np.stack([x[i] for x, i in zip(self.grid, bricks, strict=True)])
        widths = np.stack([x[i + 1] for x, i in zip(self.grid, bricks, strict=True)]) - low
        first = np.ravel_multi_index(bricks, shape)
        steps = np.array([np.ravel_multi_index(corner, shape) for corner in CORNERS])
        return first + steps[:, None], (points.T - low) / widths, widths


def _shares(local):
    """Shape functions (8, p) at local coordinates (3, p)."""
    x, y, z = ((1 - t, t) for t in local)
    return np.stack([x[a] * y[b] * z[c] for a, b, c in CORNERS])


def _slopes(local, widths):
    """Gradients (8, p, 3) of the shape functions, 1/m."""
    x, y, z = ((1 - t, t) for t in local)
    u, v, w = ((-1 / h, 1 / h) for h in widths)
    rows = [(u[a] * y[b] * z[c], x[a] * v[b] * z[c], x[a] * y[b] * w[c]) for a, b, c in CORNERS]
    return np.moveaxis(np.array(rows), 1, 2)


def hexahedra(scene, size=None) -> Space:
    """`Space` of bricks."""
    what = "hexahedra follow boxes of layers only; use tetrahedra"
    scene.require(what, domain="box", shapes=(Layer,), takes=("exchange", "image"))
    grid, phase = bricks(scene, size)
    widths = [np.diff(x) for x in grid]
    materials = scene.conductivities, capacities(scene)
    conducted, mass = stiffness(widths, materials[0][phase]), _mass(widths, materials[1][phase])
    view = partial(Bricks, scene, grid, phase)
    lumped = lumps(grid)
    points = nodes_of(grid)
    return Space(
        points=points,
        mass=mass,
        stiffness=conducted,
        volumes=outer(*lumped).ravel(),
        walls={name: wall_nodes(name, grid) for name in WALLS},
        quadratic=lambda free: None,
        separable=None if len(scene.materials) > 1 else partial(separable, grid, *(v[0] for v in materials)),
        spread=view(np.zeros(len(points))).spread,
        planes=lambda axis: grid[axis],
        spacing=min(w.min() for w in widths) / RESOLVE,
        view=view,
        fractions=np.bincount(phase.ravel(), outer(*widths).ravel(), len(scene.materials)) / scene.volume,
        stats={"elements": phase.size, "nodes": len(points), "size": float(max(w.max() for w in widths))},
    )


def bricks(scene, size=None):
    """Nodes along each axis of the bricks of a scene, and their phases."""
    size = checked_size(scene, size)
    if scene.image is not None:
        return _of_image(scene.image, size)
    grid = tuple(_grid(scene, axis, size) for axis in range(3))
    centers = np.stack(np.meshgrid(*((x[1:] + x[:-1]) / 2 for x in grid), indexing="ij"), axis=-1)
    return grid, scene.phase_at(centers.reshape(-1, 3)).reshape(centers.shape[:3])


def _of_image(image, size):
    """Equal parts of voxels."""
    parts = [math.ceil(h / size * (1 - SAME)) for h in image.voxel]
    counts = [n * m for n, m in zip(image.shape, parts, strict=True)]
    check_memory("Scene.image, as bricks,", counts, BYTES * math.prod(counts), power=3)
    grid = tuple(np.linspace(0.0, side, n + 1) for side, n in zip(image.size, counts, strict=True))
    return grid, image.phase_on(counts)


def nodes_of(grid) -> np.ndarray:
    """Nodes of a grid, (n, 3) float array, m; the last axis runs fastest."""
    return np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 3)


def lumps(grid) -> list:
    """Integrals of the shape functions along each axis of a grid, three float arrays, m."""
    return [(np.append(w, 0) + np.append(0, w)) / 2 for w in map(np.diff, grid)]


def outer(a, b, c):
    """Products a_i b_j c_k."""
    return a[:, None, None] * b[:, None] * c


def checked_size(scene, size) -> float:
    """Longest edge of the bricks of a scene."""
    if size is None:
        return scene.volume ** (1 / 3) / EDGES if scene.image is None else max(scene.image.voxel)
    finite("size", size, "a finite number > 0 m", lambda v: v > 0)
    if math.prod(math.ceil(length / size * (1 - SAME)) for length in scene.size) > MOST_CELLS:
        least = (scene.volume / MOST_CELLS) ** (1 / 3)
        raise ValueError(f"size = {size!r} m: more than {MOST_CELLS:.0e} bricks; must be >= about {least:.3g} m")
    return float(size)


def _grid(scene, axis, size):
    """Nodes along an axis: ends and surfaces of layers, and equal parts between them."""
    length = scene.size[axis]
    layers = [layer for layer in scene.inclusions if layer.axis == axis]
    planes = np.unique(np.clip([0.0, length, *(x.start for x in layers), *(x.stop for x in layers)], 0, length))
    planes = planes[np.append(True, np.diff(planes) > SAME * length)]
    planes[-1] = length
    parts = [
        np.linspace(a, b, max(1, math.ceil((b - a) / size * (1 - SAME))), endpoint=False)
        for a, b in zip(planes[:-1], planes[1:], strict=True)
    ]
    return np.concatenate([*parts, [length]])


def stiffness(widths, conductivity) -> csr_matrix:
    """Stiffness of the nodes of a grid, W/K."""
    volume, unit = outer(*widths), [np.ones(len(w)) for w in widths]
    lengths = [outer(*(widths[i] if i == a else unit[i] for i in range(3))) for a in range(3)]

    def between(p, q):
        m, k = _of_axes(MASS, p, q), _of_axes(STIFFNESS, p, q)
        return conductivity * sum(k[a] * m[a - 1] * m[a - 2] * volume / lengths[a] ** 2 for a in range(3))

    return _assembled(conductivity.shape, between)


def _mass(widths, capacity):
    """Consistent mass of the nodes of a grid, J/K."""
    volume = outer(*widths)

    def between(p, q):
        m = _of_axes(MASS, p, q)
        return capacity * volume * m[0] * m[1] * m[2]

    return _assembled(capacity.shape, between)


def _of_axes(matrix, p, q):
    return [matrix[a, b] for a, b in zip(p, q, strict=True)]


def _assembled(counts, between):
    """CSR matrix of the nodes by what stands between two corners of each brick."""
    shape = np.array(counts) + 1
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    parts = {}
    for p, q in product(CORNERS, repeat=2):
        offset = int(strides @ (np.array(q) - p))
        # A diagonal matrix of scipy keeps each entry in the place of its column.
        columns = tuple(slice(c, c + n) for c, n in zip(q, counts, strict=True))
        parts.setdefault(offset, np.zeros(shape))[columns] += between(p, q)
    count = int(np.prod(shape))
    return dia_matrix((np.array([d.ravel() for d in parts.values()]), list(parts)), shape=(count, count)).tocsr()


def wall_nodes(name, grid) -> WallNodes:
    """A face of the box on the nodes."""
    axis, ends = "xyz".index(name[0]), lumps(grid)
    ends[axis] = np.zeros(len(grid[axis]))
    ends[axis][0 if name[1] == "-" else -1] = 1.0
    weights = outer(*ends).ravel()
    return WallNodes(np.flatnonzero(weights), weights, partial(_face, name, grid))


def _face(name, grid):
    """`Surface` of a face: bilinear rectangles, with as many points of Gauss as fourth powers ask for."""
    axis, shape = "xyz".index(name[0]), [len(x) for x in grid]
    first, second = (a for a in range(3) if a != axis)
    numbers = np.take(np.arange(np.prod(shape)).reshape(shape), 0 if name[1] == "-" else -1, axis=axis)
    nodes = np.stack([numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, :-1], numbers[1:, 1:]], axis=-1).reshape(-1, 4)
    places, weights = np.polynomial.legendre.leggauss(FACE)
    u, v = (part.ravel() for part in np.meshgrid(0.5 + places / 2, 0.5 + places / 2, indexing="ij"))
    values = np.column_stack([(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v])
    areas = (
        np.outer(np.diff(grid[first]), np.diff(grid[second])).reshape(-1, 1) * np.outer(weights, weights).ravel() / 4
    )
    return Surface(nodes, values, areas, int(np.prod(shape)))
