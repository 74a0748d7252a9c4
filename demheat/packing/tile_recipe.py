"""How the tiles that come with the package were made: `python -m demheat.packing.tile_recipe FILE` makes them again.

Equal particles are relaxed in a periodic cube, then moved into the centroids of their Voronoi cells again and again
(Lloyd's method). A two-point flux of a linear temperature is exact on any cells; of a bent one it is off by what cells
are off centre. What that gains over relaxed packings is told in docs/decisions/tile.md.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.spatial import Voronoi

from demheat.packing.radii import Gaussian
from demheat.packing.relax import relax
from demheat.packing.tile import PARTS, numbers
from demheat.runtime.paths import replaced

# Steps of Lloyd's method: particles then move by less than a hundredth of their distance in one more.
STEPS = 150
# Images that are nearer to the cube than so many mean distances may bound its cells.
REACH = 3.2


def make(number: int) -> np.ndarray:
    """Points of one tile, (number, 3) uint16 array, parts of its edge."""
    points = relax(number, radii=Gaussian(spread=0.0), seed=number, allow_few=True).centers
    for _ in range(STEPS):
        points = centroids(points) % 1.0
    return (np.floor(points * PARTS).astype(np.int64) % PARTS).astype(np.uint16)


def centroids(points):
    """Centroids of the Voronoi cells of points in the periodic unit cube, (n, 3) float array."""
    number = len(points)
    around = np.array([shift for shift in np.ndindex(3, 3, 3) if shift != (1, 1, 1)]) - 1.0
    images = (points + around[:, None]).reshape(-1, 3)
    reach = REACH / np.cbrt(number)
    images = images[np.all((images > -reach) & (images < 1.0 + reach), axis=1)]
    cells = Voronoi(np.concatenate([points, images]))
    faces = np.flatnonzero((cells.ridge_points < number).any(axis=1))
    corners = [cells.ridge_vertices[face] for face in faces]
    counts = np.array([len(face) for face in corners])
    owner, corner = np.repeat(np.arange(len(faces)), counts), cells.vertices[np.concatenate(corners)]
    start = np.cumsum(counts) - counts
    after = np.arange(1, len(corner) + 1)
    after[start + counts - 1] = start
    middle = (np.add.reduceat(corner, start) / counts[:, None])[owner]
    volumes, sums = np.zeros(number), np.zeros((number, 3))
    for side in cells.ridge_points[faces].T:
        # A tetrahedron for each edge of a face: its two ends, the face's middle and the cell's point.
        apex = cells.points[side][owner]
        volume = np.abs(np.einsum("ij,ij->i", np.cross(corner - apex, corner[after] - apex), middle - apex)) / 6.0
        centre = (corner + corner[after] + middle + apex) / 4.0
        cell = side[owner]
        own = cell < number
        volumes += np.bincount(cell[own], volume[own], number)
        for axis in range(3):
            sums[:, axis] += np.bincount(cell[own], (volume * centre[:, axis])[own], number)
    return sums / volumes[:, None]


def main(path) -> None:
    """Make all tiles and write them."""
    tiles = [make(number) for number in numbers()]
    with replaced(Path(path)) as temporary, temporary.open("wb") as file:
        np.save(file, np.concatenate(tiles))


if __name__ == "__main__":
    main(sys.argv[1])
