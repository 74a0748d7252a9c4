"""Slopes of the temperature along surfaces that resist heat: they differ on the two sides, and corners see their mean.

A voxel knows one gradient, by its corners. Along a film those on one side see the slope s of that side, those on the
other the other's, so the voxel conducts sum(f k s^2) over the square of their mean, f the parts of its phases: without
that a body of good conductors behind a film would conduct where only its outside has a slope.
"""

from itertools import product

import numpy as np

from references.voxels.solids import window

# Of a voxel: corners so far in a body are in it, so surfaces on the grid's planes are in the voxels within; corners on
# a wall are looked at from within, so surfaces on it are in none.
INWARD = 1e-7
# Most that a voxel conducts along a film over its best conductor, where nearly all of it is behind the film: iterations
# would be more, and a tenth of a per cent is gained at most.
MOST = 4.0
CORNERS = np.array(list(product((0, 1), repeat=3)))


def slopes_behind(scene, areas, volumes) -> np.ndarray:
    """Slopes of the temperature along surfaces in each phase, over that outside of them all.

    In a ball of the conductivity k and radius a behind a resistance R it is 1/(1 + k R/a) of that on its outside; a
    body of another form has three of its volumes over its surface for a. Along layers it is the same on either side.
    """
    parents, own, slopes = scene.parents(), volumes.copy(), np.ones(len(volumes))
    for phase in range(len(volumes) - 1, 0, -1):
        own[parents[phase]] += own[phase]
    for phase, shape in enumerate(scene.inclusions, start=1):
        slopes[phase] = slopes[parents[phase]]
        if shape.resistance > 0 and not shape.flat:
            slopes[phase] /= 1 + scene.conductivities[phase] * shape.resistance * areas[phase] / (3 * own[phase])
    return slopes


def seen(scene, shape, slopes) -> np.ndarray:
    """Mean slope that the corners of each voxel see."""
    found, spacing = np.ones(np.array(shape) + 1), np.array(scene.size) / shape
    for phase, each in enumerate(scene.inclusions, start=1):
        if slopes[phase] == 1.0:
            continue
        for image in each.images(scene.size, periodic=scene.periodic):
            low, high, inside = corners(image, shape, spacing, scene)
            found[tuple(map(slice, low, high + 1))][inside] = slopes[phase]
    return sum(pieces(found)) / len(CORNERS)


def pieces(values):
    """Values of the eight corners of all voxels, one corner after the other."""
    ends = np.array(values.shape) - 1
    return (values[tuple(map(slice, corner, ends + corner))] for corner in CORNERS)


def corners(shape, counts, spacing, scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First voxels along axes that a shape may meet, those after the last, and which of their corners are in it."""
    low, high = window(shape, np.array(counts), spacing, clipped=True)
    low, high = np.maximum(low - 1, 0), np.minimum(high + 1, counts)
    axes = [np.arange(a, b + 1) * h for a, b, h in zip(low, high, spacing, strict=True)]
    if not scene.periodic:
        ends = [2 * INWARD * h for h in spacing]
        axes = [np.clip(x, end, side - end) for x, end, side in zip(axes, ends, scene.size, strict=True)]
    found = np.empty([len(x) for x in axes], bool)
    plane = np.empty((found[0].size, 3))
    plane[:, 1:] = np.stack(np.meshgrid(*axes[1:], indexing="ij"), axis=-1).reshape(-1, 2)
    # Plane by plane: no array of points as large as the grid.
    for number, x in enumerate(axes[0]):
        plane[:, 0] = x
        found[number] = (shape.distance(plane) < -INWARD * spacing.min()).reshape(found[0].shape)
    return low, high, found
