"""Points all over the surface of a shape, each with the area that it stands for, by cells that close in on it."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from demheat.scene.beats import beat
from demheat.scene.shapes.sections import below

# Cells along the longest side that are looked at first, and looked at together.
FIRST, BLOCK = 16, 1 << 16
# Distances are exact or nearly so: a cell whose middle is farther off than this many half diagonals has no surface.
SLACK = 1.5
# Of the distance that is wanted, at most: cells in which points are found to choose from.
CLOSER = 0.35
# Cells along the longest side by which volumes are found.
CELLS = 48


def cells_on(shape, low, high, pitch: float) -> tuple[np.ndarray, np.ndarray]:
    """Cells of a box that the surface of a shape may cut."""
    span = np.asarray(high, dtype=float) - low
    counts = np.maximum(1, np.ceil(span / span.max() * min(FIRST, np.ceil(span.max() / pitch)))).astype(int)
    sides = span / counts
    grid = np.meshgrid(*map(np.arange, counts), indexing="ij")
    centers = low + (np.stack(grid, axis=-1).reshape(-1, 3) + 0.5) * sides
    centers = _near(shape, centers, sides)
    while sides.max() > pitch * (1 + 1e-9):
        # Cells stay nearly cubic.
        halved = sides > 0.75 * sides.max()
        sides = np.where(halved, sides / 2, sides)
        shifts = np.array(list(product(*((-0.5, 0.5) if half else (0.0,) for half in halved)))) * sides
        centers = np.concatenate([_near(shape, (b[:, None] + shifts).reshape(-1, 3), sides) for b in _blocks(centers)])
    return centers, sides


def surface_points(shape, low, high, pitch: float) -> tuple[np.ndarray, np.ndarray]:
    """Points on the surface of a shape, in a box, and the area of each."""
    centers, sides = cells_on(shape, low, high, pitch)
    found = [(np.empty((0, 3)), np.empty(0))]
    for block in _blocks(centers):
        distance, normal = shape.surface(block)
        area = below(normal, distance, sides)[1]
        points = block - distance[:, None] * normal
        found.append((points[area > 0], area[area > 0]))
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


def closer_points(shape, low, high, widest: float, wanted) -> tuple[np.ndarray, np.ndarray]:
    """Points to choose from on the surface of a shape in a box, where less than a spacing is wanted, and normals.

    `wanted` says of points and normals which distance they are to have, and changes along a way by no more than that.
    """
    centers, sides = cells_on(shape, low, high, CLOSER * widest)
    found = [(np.empty((0, 3)), np.empty((0, 3)))]
    while len(centers):
        half, kept = 0.5 * np.linalg.norm(sides), []
        for block in _blocks(centers):
            distance, normal = shape.surface(block)
            points = block - distance[:, None] * normal
            spacing = wanted(points, normal)
            fine = sides.max() <= CLOSER * spacing
            found.append(
                tuple(column[fine & (spacing < widest) & (np.abs(distance) <= half)] for column in (points, normal))
            )
            kept.append(block[~fine & (spacing - half < widest)])
        centers, sides = _halved(shape, np.concatenate(kept), sides)
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


def _halved(shape, centers, sides):
    """Eighths of cells that the surface may cut, all axes halved."""
    shifts = np.array(list(product((-0.25, 0.25), repeat=3))) * sides
    return np.concatenate(
        [_near(shape, (b[:, None] + shifts).reshape(-1, 3), 0.5 * sides) for b in _blocks(centers)]
    ), 0.5 * sides


def volume_by_cells(shape, low, high) -> float:
    """Volume of what of a shape lies in a box, m3: in cells that its surface cuts by planes, of two sizes."""
    fine, coarse = (_volume(shape, low, high, cells) for cells in (CELLS, CELLS // 2))
    # What planes lack of a bent surface is of second order.
    return fine + (fine - coarse) / 3


def _volume(shape, low, high, cells):
    centers, sides = cells_on(shape, low, high, float((high - low).max()) / cells)
    distance, normal = shape.surface(centers)
    part, _ = below(normal, distance, sides)
    # Whole cells: all columns of cells less those that are cut.
    counts = np.rint((high - low) / sides).astype(int)
    whole = 0
    for x in range(counts[0]):
        grid = np.meshgrid([x], np.arange(counts[1]), np.arange(counts[2]), indexing="ij")
        whole += int(shape.contains(low + (np.stack(grid, -1).reshape(-1, 3) + 0.5) * sides).sum())
    whole -= int(shape.contains(centers).sum())
    return float(np.prod(sides) * (whole + part.sum()))


def _near(shape, centers, sides):
    """The centres of cells that the surface may cut."""
    half = 0.5 * SLACK * np.linalg.norm(sides)
    return np.concatenate([b[np.abs(shape.distance(b)) <= half] for b in _blocks(centers)])


def _blocks(points) -> Iterator[np.ndarray]:
    """Points in parts of limited number; one empty part of none."""
    for start in range(0, max(len(points), 1), BLOCK):
        beat("samples of a surface")
        yield points[start : start + BLOCK]
