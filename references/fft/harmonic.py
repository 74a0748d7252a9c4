"""Temperatures and slopes at points by harmonic polynomials through the voxels around them.

In a steady state the temperature of a phase that conducts alike all round is harmonic: sixteen polynomials are all
there are up to the third degree.  They are fitted by weighted least squares to the whole voxels of the point's own
phase that are nearest to it and joined to it, on its side of every interface.
"""

from typing import NamedTuple

import numpy as np

from references.fft.grid import Grid

# Voxels of the cube around a point: so many on either side of the eight whose centres surround it.
DEPTH = 3
SIDE = 2 * DEPTH + 2
# Weights fall to zero at the so-manieth voxel. In bodies, where fields are smooth, voxels' errors count; around
# bodies what a cubic leaves out. Found on spheres by 16 to 64 voxels along an edge.
AROUND, WITHIN = 30, 72
# With fewer voxels, or farther than so many edges, interpolation is as near.
LEAST_AROUND, LEAST_WITHIN, FARTHEST = 28, 40, 3.25
# In a body a degree is too much if errors of 1 K make a slope be off by more than this, in K per edge: where the
# surroundings conduct worse, they are large beside the body's own slope.
MOST = 1.0
# Whole voxels of other phases that there must be around a point beside an interface: fewer do not resolve a body, which
# steps of voxels resolve worse than what cuts them.
RESOLVED, STEPPED = 12, 24
# Voxels, nearest first, of which one must be seen from a point, and the places on the way where its phase is asked.
SEEN, PLACES = 12, 6
# Of a square of a distance, or a conductivity: less is rounding.
EQUAL = 1e-9
# Polynomials up to each degree, and the condition of the normal equations beyond which a degree is not known.
COUNTS, WORST = (16, 9, 4), 1e8
# Points at once: some 20 MiB.
BLOCK = 1000


class Fit(NamedTuple):
    """What is known at points, in the order of the box."""

    known: np.ndarray  # (n,) bool array
    temperature: np.ndarray  # (n,) float array, K
    slope: np.ndarray  # (n, 3) float array, K/m


class Places(NamedTuple):
    """Some points, in the order of the box."""

    points: np.ndarray
    phase: np.ndarray
    body: np.ndarray | None
    within: np.ndarray  # (n,) bool array: In bodies with none in them


class Cube(NamedTuple):
    """Voxels around points, a row for each point."""

    flat: np.ndarray  # (n, SIDE^3) int array: Flat indices
    square: np.ndarray  # (n, SIDE^3) float array: Squares of distances, in edges of a voxel
    along: np.ndarray  # (n, SIDE, 3) float array: Offsets along each axis, in edges
    sign: np.ndarray  # (n, SIDE) float array: Of what is less than linear, by the place along the first axis


def fitted(grid: Grid, points: np.ndarray, phase: np.ndarray, body: np.ndarray | None) -> Fit:
    """Fits at points in the order of the box, of known phase and body."""
    fit = Fit(np.zeros(len(points), bool), np.zeros(len(points)), np.zeros((len(points), 3)))
    if not suits(grid):
        return fit
    cut, inner = _cut(grid), _inner(grid.scene)
    for start in range(0, len(points), BLOCK):
        part = slice(start, start + BLOCK)
        at = Places(points[part], phase[part], None if body is None else body[part], inner[phase[part]])
        for whole, own in zip(fit, _block(grid, cut, at), strict=True):
            whole[part] = own
    fit.known[...] &= _alike(grid.voxels)[phase]
    if body is not None:
        fit.known[...] &= np.append(grid.bodies.passing, False)[body]
    return fit


def suits(grid: Grid) -> bool:
    """Whether fits are made at all.

    Not of some planes of a grid; of images, whose steps have edges; where temperatures ring.
    """
    return grid.planes is None and grid.scene.image is None and not grid.rings


def _cut(grid):
    """Which voxels are not wholly of one phase, flat; by faces to others where nobody asked what surfaces cut."""
    phase = grid.voxels.phase
    cut = np.zeros(phase.shape, bool)
    cut.flat[grid.voxels.cut] = True
    if len(grid.voxels.cut):
        return cut.reshape(-1)
    for axis in range(3):
        below = phase != np.roll(phase, 1, axis)
        if not grid.scene.periodic:
            below[(slice(None),) * axis + (0,)] = False
        cut |= below | np.roll(below, -1, axis)
    return cut.reshape(-1)


def _alike(voxels):
    """Which phases conduct alike all round."""
    if voxels.tensors is None:
        return np.ones(len(voxels.conductivity), bool)
    alike = voxels.conductivity[:, None] * (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    return np.all(np.abs(voxels.tensors - alike) <= EQUAL * voxels.conductivity[:, None], axis=1)


def _inner(scene):
    """Which phases are bodies with none in them."""
    inner = np.zeros(len(scene.materials), bool)
    if scene.inclusions:
        inner[1:] = True
        inner[scene.parents()[1:]] = False
    return inner


def _block(grid, cut, at):
    """Fits at some places."""
    cube = _cube(grid, at.points)
    whole, same = _held(grid, cut, cube.flat, at)
    square = np.where(_joined(grid, at, whole, cube), cube.square, np.inf)
    near, square = _nearest(square, WITHIN)
    away, warm = _voxels(grid, cube, near)
    number = np.minimum(np.isfinite(square).sum(axis=1), np.where(at.within, WITHIN, AROUND))
    radius = np.sqrt(np.take_along_axis(square, np.maximum(number - 1, 0)[:, None], axis=1)[:, 0])
    enough = number >= np.where(at.within, LEAST_WITHIN, LEAST_AROUND)
    enough &= at.within | ((radius < FARTHEST) & _resolved(grid, whole, same, cube.square, radius))
    fit = Fit(enough, np.zeros(len(enough)), np.zeros((len(enough), 3)))
    some = np.flatnonzero(enough)
    weights = np.maximum(1.0 - square[some] / radius[some, None] ** 2, 0.0)
    most = np.where(at.within[some], MOST, np.inf)
    found = solved(away[some], weights, warm[some], radius[some], most)
    for whole, own in zip(fit, found, strict=True):
        whole[some] = own
    temperature = grid.level + at.points @ grid.slope + fit.temperature
    return fit._replace(temperature=temperature, slope=fit.slope / grid.voxels.spacing.mean())


def _nearest(square, count):
    """The so many nearest of each row, and their squares, ascending."""
    near = np.argpartition(square, count - 1, axis=1)[:, :count]
    found = np.take_along_axis(square, near, axis=1)
    order = np.argsort(found, axis=1)
    return np.take_along_axis(near, order, axis=1), np.take_along_axis(found, order, axis=1)


def solved(away, weights, values, radius, most) -> tuple:
    """Whether it is known, value and slope at the origin of the highest degree that is well enough posed.

    away : (n, m, 3) offsets; weights, values : (n, m), values without a weight count nothing; radius : (n,), of the
    weights' reach; most : (n,), see `MOST`
    """
    n, values = len(away), np.where(weights > 0, values, 0.0)
    mean = np.sum(weights * values, axis=1) / weights.sum(axis=1)
    basis = polynomials(away / radius[:, None, None])
    weighted = (basis * weights[..., None]).transpose(0, 2, 1)
    normal, noise = weighted @ basis, weighted @ weighted.transpose(0, 2, 1)
    right = (weighted @ (values - mean[:, None])[..., None])[..., 0]
    known, found = np.zeros(n, bool), np.zeros((n, 4))
    for count in COUNTS:
        some = np.flatnonzero(~known)
        if not len(some):
            break
        inverse, posed = _inverse(normal[some, :count, :count])
        slopes = inverse[:, 1:4]
        spread = np.einsum("nij,njk,nik->n", slopes, noise[some, :count, :count], slopes)
        good = posed & (np.sqrt(np.maximum(spread, 0.0)) < most[some] * radius[some])
        known[some[good]] = True
        found[some[good]] = np.einsum("nij,nj->ni", inverse[good, :4], right[some[good], :count])
    return known, mean + found[:, 0], found[:, 1:] / radius[:, None]


def polynomials(x: np.ndarray) -> np.ndarray:
    """The harmonic ones up to the third degree, by degrees: (..., 3) -> (..., 16)."""
    x, y, z = np.moveaxis(x, -1, 0)
    xx, yy, zz = x * x, y * y, z * z
    flat = xx - yy
    up = 4.0 * zz - xx - yy
    second = (x * y, y * z, x * z, flat, 2.0 * zz - xx - yy)
    third = (x * y * z, z * flat, z * (2.0 * zz - 3.0 * (xx + yy)), x * up, y * up, x * (xx - 3.0 * yy))
    return np.stack([np.ones_like(x), x, y, z, *second, *third, y * (3.0 * xx - yy)], axis=-1)


def _inverse(matrices):
    """Inverses, and whether a matrix whose columns are made equally long has one that rounding leaves as it is."""
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("nii->ni", matrices), np.finfo(float).tiny))
    sizes, vectors = np.linalg.eigh(matrices * scale[:, :, None] * scale[:, None, :])
    posed = sizes[:, 0] * WORST > sizes[:, -1]
    sizes = np.where(posed[:, None], sizes, 1.0)
    inverse = (vectors / sizes[:, None, :]) @ vectors.transpose(0, 2, 1)
    return inverse * scale[:, :, None] * scale[:, None, :], posed


def _cube(grid, points):
    """The voxels around each point, mirrored in the walls."""
    shape, spacing = np.array(grid.temperature.shape), grid.voxels.spacing
    place = points / spacing - 0.5
    number = np.floor(place).astype(int)[:, None] + np.arange(-DEPTH, DEPTH + 2)[:, None]
    along = (number - place[:, None]) * (spacing / spacing.mean())
    index = number % (shape if grid.scene.periodic else 2 * shape)
    index = np.minimum(index, 2 * shape - 1 - index)
    # What is less than linear changes its sign where it is mirrored in an isothermal wall.
    mirrored = np.any(number[..., 0] != index[..., 0]) and not grid.scene.periodic
    sign = np.where(number[..., 0] != index[..., 0], -1.0, 1.0) if mirrored else np.ones(number.shape[:2])
    flat = _outer(*np.moveaxis(index * (shape[1] * shape[2], shape[2], 1), -1, 0))
    return Cube(flat, _outer(*np.moveaxis(along**2, -1, 0)), along, sign)


def _outer(x, y, z):
    """Sums of one number of each of three rows, (n, a) each -> (n, a^3), of each of n."""
    return (x[:, :, None, None] + y[:, None, :, None] + z[:, None, None, :]).reshape(len(x), SIDE**3)


def _voxels(grid, cube, near):
    """Offsets in edges from each point to voxels of its cube, and temperatures there less the linear part here."""
    places = np.unravel_index(near, (SIDE,) * 3)
    away = np.stack([np.take_along_axis(cube.along[..., axis], places[axis], axis=1) for axis in range(3)], axis=-1)
    own = grid.temperature.reshape(-1)[np.take_along_axis(cube.flat, near, axis=1)]
    own = own * np.take_along_axis(cube.sign, places[0], axis=1)
    return away, own + away @ (grid.voxels.spacing.mean() * grid.slope)


def _held(grid, cut, flat, at):
    """Which voxels are wholly of the point's own phase and body; which of its phase, or cut."""
    same = grid.voxels.phase.reshape(-1)[flat] == at.phase[:, None]
    whole = ~cut[flat]
    own = same & whole
    if at.body is not None:
        own &= grid.bodies.label.reshape(-1)[flat] == at.body[:, None]
    return own, same | ~whole


def _resolved(grid, whole, same, square, radius):
    """Whether what is beside a point is as large as voxels: some are wholly of it, or there is nothing."""
    clear = whole | (square > radius[:, None] ** 2)
    least = RESOLVED if len(grid.voxels.cut) else STEPPED
    return clear.all(axis=1) | ((~same).sum(axis=1) >= least)


def _joined(grid, at, whole, cube):
    """Which whole voxels are joined, face by face in the cube, to one that is seen from the point."""
    some = np.flatnonzero(~(whole | (cube.square > FARTHEST**2)).all(axis=1))
    shape = (len(some), SIDE, SIDE, SIDE)
    seed = _seed(grid, at, whole, cube, some)
    joined = whole.copy()
    joined[some] = grown(seed.reshape(shape), whole[some].reshape(shape)).reshape(len(some), SIDE**3)
    return joined


def grown(seed: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """What of (n, a, b, c) bool arrays faces join to a seed, in as many steps as the cube has edges."""
    for _ in range(SIDE):
        more = seed.copy()
        for axis in (1, 2, 3):
            low = (slice(None),) * axis + (slice(None, -1),)
            high = (slice(None),) * axis + (slice(1, None),)
            more[high] |= seed[low]
            more[low] |= seed[high]
        seed = more & whole
    return seed


def _seed(grid, at, whole, cube, some):
    """The nearest voxels that are seen from each of some points through its own phase."""
    near, square = _nearest(np.where(whole[some], cube.square[some], np.inf), SEEN)
    own = Cube(*(part[some] for part in cube))
    way, seen = _voxels(grid, own, near)[0] * grid.voxels.spacing.mean(), np.isfinite(square)
    size, phase = grid.scene.size, at.phase[some, None]
    for part in (np.arange(PLACES) + 0.5) / PLACES:
        place = at.points[some, None] + part * way
        if not grid.scene.periodic:
            place = size - np.abs(size - np.abs(place))
        seen &= grid.scene.phase_at(place.reshape(-1, 3)).reshape(seen.shape) == phase
    # Two are as near to a point on a wall.
    seen &= square <= np.where(seen, square, np.inf).min(axis=1, keepdims=True) * (1.0 + EQUAL)
    mask = np.zeros((len(some), SIDE**3), bool)
    np.put_along_axis(mask, near, seen, axis=1)
    return mask
