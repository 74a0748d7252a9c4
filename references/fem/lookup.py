"""Values of a finite element solution at any point: which element, where in it, what there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from demheat.field import Samples
from demheat.scene import Scene
from demheat.scene.resistances import joined
from references.fem import interfaces
from references.fem.elements import at_quadrature, inverse, shapes
from references.fem.medium import Medium
from references.mesh import Mesh

# Local coordinates this little outside count as inside: rounding of points on a face.
INSIDE = 1e-9
# Beyond this a point of the box is in no element: the mesh would have a hole.
LOST = 1e-6
# Elements tried by their centres; the few points that remain are tested against all bounding boxes.
NEAREST = (8, 64)
# Points looked up together: about 100 MB at 8 candidates.
CHUNK = 50_000


@dataclass(frozen=True)
class NodalField:
    """Nodal temperatures (n,) of a scene on a mesh; `lost` is how far out, in local coordinates, is in no element.

    Of the elements, (m,) bool arrays, `still` are those that no heat passes, `open` those without a temperature.
    """

    scene: Scene
    mesh: Mesh
    temperature: np.ndarray
    lost: float = LOST
    still: np.ndarray | None = None
    open: np.ndarray | None = None

    @cached_property
    def conductivity(self):
        """Mean over directions of each element, 0 where no heat passes, (m,) float array, W/(m K)."""
        conductivity = self.scene.mean_conductivities[self.mesh.phase]
        return conductivity if self.still is None else np.where(self.still, 0.0, conductivity)

    @cached_property
    def medium(self):
        """What makes the flux of gradients, beside the mean conductivity."""
        return Medium(self.scene, self.mesh, self.temperature)

    def samples(self):
        """`Samples` at quadrature points inside all elements."""
        rows = []
        for ids, points, volumes, temperature, gradient in at_quadrature(self.mesh, self.temperature, degree=7):
            phase = np.repeat(self.mesh.phase[ids], volumes.shape[1])
            gradient = self.medium.conducted(ids, temperature, gradient)
            flux = -np.repeat(self.conductivity[ids], volumes.shape[1])[:, None] * gradient.reshape(-1, 3)
            temperature = temperature.reshape(volumes.shape)
            if self.open is not None:
                temperature = np.where(self.open[ids][:, None], np.nan, temperature)
            rows.append((points.reshape(-1, 3), volumes.ravel(), temperature.ravel(), phase, flux))
        return Samples(*(np.concatenate(column) for column in zip(*rows, strict=True)))

    def temperature_at(self, points):
        """Temperature at (n, 3) points in metres, (n,) float array."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        inside = self._inside(points)
        temperature = np.empty(len(points))
        for part, ids, X in self._located(inside):
            values, _ = shapes(self.mesh.cells.shape[1], X.T)
            temperature[part] = np.einsum("pn,pn->p", values, self.temperature[self.mesh.cells[ids]])
            if self.open is not None:
                temperature[part][self.open[ids]] = np.nan
        if self.scene.periodic:
            temperature += (points - inside) @ np.array(self.scene.gradient)
        return temperature

    def flux_at(self, points):
        """Flux density at (n, 3) points in metres, (n, 3) float array, W/m2; on an interface that of one side."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        flux = np.empty((len(points), 3))
        for part, ids, X in self._located(self._inside(points)):
            cells = self.mesh.cells[ids]
            values, slopes = shapes(cells.shape[1], X.T)
            back, _ = inverse(np.einsum("pnx,pnk->pxk", self.mesh.points[cells], slopes))
            gradient = np.einsum("pnk,pkx,pn->px", slopes, back, self.temperature[cells], optimize=True)
            temperature = np.einsum("pn,pn->p", values, self.temperature[cells])
            gradient = self.medium.conducted(ids, temperature, gradient)
            flux[part] = -self.conductivity[ids, None] * gradient
        return flux

    def mean_flux(self):
        """Flux density averaged over the volume of the body, (3,) float array, W/m2."""
        total = np.zeros(3)
        for ids, _, volumes, temperature, gradient in self._at_quadrature():
            gradient = self.medium.conducted(ids, temperature, gradient)
            total -= self.conductivity[ids] @ np.einsum("bq,bqx->bx", volumes, gradient)
        return total / self.scene.volume

    def power(self):
        """Minus flux times gradient over the volume of the body, and what interfaces take, W K."""
        total = 0.0
        for ids, _, volumes, temperature, gradient in self._at_quadrature():
            square = gradient * self.medium.conducted(ids, temperature, gradient)
            total += float(self.conductivity[ids] @ np.einsum("bq,bqx->b", volumes, square))
        if self.mesh.faces is not None:
            total += interfaces.power(self.mesh, self.temperature, self.scene.gradient or np.zeros(3))
        return total

    def _at_quadrature(self):
        return at_quadrature(self.mesh, self.temperature, straight=self.medium.straight)

    def spread(self, points, amounts):
        """Share amounts at points among the nodes by their shape functions."""
        total = np.zeros(len(self.mesh.points))
        for part, ids, X in self._located(self._inside(np.asarray(points, dtype=float))):
            values, _ = shapes(self.mesh.cells.shape[1], X.T)
            shares = amounts[part, None] * values
            total += np.bincount(self.mesh.cells[ids].ravel(), shares.ravel(), len(total))
        return total

    def _inside(self, points):
        """The points, in a periodic cell moved into the box."""
        box = np.array(self.scene.size)
        if self.scene.periodic and np.all(np.isfinite(points)):
            return points % box
        outside = ~np.all((points >= -INSIDE * box) & (points <= (1 + INSIDE) * box), axis=1)
        if outside.any():
            raise ValueError(f"points: {points[outside][0]} lies outside the box {self.scene.size}")
        return np.clip(points, 0, box)

    def _located(self, points):
        """Yield (slice, elements, local coordinates) for one chunk of points after the other."""
        for start in range(0, len(points), CHUNK):
            part = slice(start, start + CHUNK)
            found = self._locate(points[part])
            yield part, *(found if self.mesh.faces is None else self._on_side(points[part], *found))

    @cached_property
    def _centers(self):
        return cKDTree(self.mesh.points[self.mesh.cells[:, :4]].mean(axis=1))

    def _on_side(self, points, ids, X):
        """The same, but for points whose own side of an interface begins beside their element: the nearest one there.

        Elements miss a curved interface by a little, the temperature jumps there by much more.
        """
        sides = joined(self.scene)
        wanted, own = sides[self.scene.phase_at(points)], sides[self.mesh.phase]
        off = wanted != own[ids]
        for side in np.unique(wanted[off]):
            rows, among = np.flatnonzero(off & (wanted == side)), np.flatnonzero(own == side)
            if not len(among):
                continue
            near = cKDTree(self._centers.data[among]).query(points[rows], min(NEAREST[0], len(among)))[1]
            near = among[near.reshape(len(rows), -1)]
            local = np.stack([_local(self.mesh, column, points[rows]) for column in near.T], axis=1)
            best = np.argmax(np.minimum(local.min(axis=2), 1 - local.sum(axis=2)), axis=1)
            ids[rows], X[rows] = near[np.arange(len(rows)), best], local[np.arange(len(rows)), best]
        return ids, X

    @cached_property
    def _bounds(self):
        nodes = self.mesh.points[self.mesh.cells]
        # A curved edge bulges past its three nodes by less than a quarter of their extent.
        low, high = nodes.min(axis=1), nodes.max(axis=1)
        return low - (high - low) / 4, high + (high - low) / 4

    def _locate(self, points):
        ids, X = np.zeros(len(points), int), np.zeros((len(points), 3))
        depth = np.full(len(points), -np.inf)

        def attempt(rows, elements):
            local = _local(self.mesh, elements, points[rows])
            new = np.minimum(local.min(axis=1), 1 - local.sum(axis=1))
            better = new > depth[rows]
            rows = rows[better]
            ids[rows], X[rows], depth[rows] = elements[better], local[better], new[better]

        for nearest in NEAREST:
            todo = np.flatnonzero(depth < -INSIDE)
            if not len(todo):
                return ids, X
            candidates = self._centers.query(points[todo], min(nearest, len(self.mesh.cells)))[1]
            for column in candidates.reshape(len(todo), -1).T:
                open_ = depth[todo] < -INSIDE
                attempt(todo[open_], column[open_])
        low, high = self._bounds
        for row in np.flatnonzero(depth < -INSIDE):
            elements = np.flatnonzero(np.all((points[row] >= low) & (points[row] <= high), axis=1))
            for element in elements:
                attempt(np.array([row]), np.array([element]))
        if depth.min(initial=0.0) < -self.lost:
            raise RuntimeError(f"no element contains the point {points[np.argmin(depth)]}")
        return ids, X


def _local(mesh, ids, points):
    """Local coordinates (p, 3) of points in given elements; far outside a curved one, those of its corners."""
    corners = mesh.points[mesh.cells[ids, :4]]
    J = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    back, _ = inverse(J)
    X = np.einsum("pkx,px->pk", back, points - corners[:, 0])
    curved = np.flatnonzero(mesh.curved[ids] & np.all(np.abs(X - 0.25) < 2, axis=1))
    nodes = mesh.points[mesh.cells[ids[curved]]]
    for _ in range(8 if len(curved) else 0):  # Newton: 4 steps reach rounding from a point inside
        values, slopes = shapes(10, X[curved].T)
        miss = points[curved] - np.einsum("pn,pnx->px", values, nodes)
        back, _ = inverse(np.einsum("pnx,pnk->pxk", nodes, slopes))
        X[curved] = np.clip(X[curved] + np.einsum("pkx,px->pk", back, miss), -3, 4)
    return X
