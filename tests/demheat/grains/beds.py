"""Crystals and a random bed of grains for the tests."""

import numpy as np

from demheat.packing import make_packing

SITES = {
    "sc": [[0.5, 0.5, 0.5]],
    "bcc": [[0.25, 0.25, 0.25], [0.75, 0.75, 0.75]],
    "fcc": [[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]],
}
# Nearest distance over the edge, and how many are so near.
NEAREST = {"sc": (1.0, 6), "bcc": (np.sqrt(3) / 2, 8), "fcc": (np.sqrt(0.5), 12)}
RADIUS = 1e-3


def crystal(kind, cells=(3, 3, 3), *, apart=0.0, periodic=True):
    """Equal spheres, `apart` radii between the surfaces of neighbours."""
    edge = (2.0 + apart) * RADIUS / NEAREST[kind][0]
    corners = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    centers = (edge * (corners + np.array(SITES[kind]))).reshape(-1, 3)
    return make_packing(centers, np.full(len(centers), RADIUS), edge * np.array(cells), periodic, {})


def random_bed(number=60, *, periodic=(True, True, False), seed=0):
    """Spheres of unlike radii at random, some of them overlapping a little."""
    rng = np.random.default_rng(seed)
    radii = RADIUS * rng.uniform(0.8, 1.2, number)
    size = np.full(3, np.cbrt(number * 4 / 3 * np.pi * RADIUS**3 / 0.6))
    centers = np.empty((0, 3))
    # Twenty draws, and the one that keeps farthest from those before.
    for k in range(number):
        drawn = np.maximum(rng.random((200, 3)), 1e-12) * size
        away = drawn[:, None] - centers
        away -= np.where(periodic, size * np.round(away / size), 0.0)
        room = (np.linalg.norm(away, axis=2) - radii[:k]).min(axis=1, initial=np.inf)
        centers = np.vstack((centers, drawn[np.argmax(room)]))
    return make_packing(centers, radii, size, periodic, {})
