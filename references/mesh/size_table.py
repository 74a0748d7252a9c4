"""Sizes of elements looked up: what asks for small ones, sorted into cells of the box, for gmsh to ask everywhere."""

import numpy as np

from references.mesh.sizes import GROWTH, Sizes

# Numbers at the head of a table.
HEAD = 10
# Relative: what asks for so little more than the least asked for is kept, for rounding.
CLOSE = 1e-6
CORNERS = np.array(list(np.ndindex(2, 2, 2)))


def table(sizes: Sizes, box) -> np.ndarray:
    """Balls and shells sorted into cells of the box, as `references.mesh.size_kernels.size_at` reads them."""
    shells = sizes.shells
    features = np.vstack(
        [
            np.column_stack([sizes.balls, np.zeros(len(sizes.balls))]),
            np.column_stack([shells[:, :3], shells[:, 3:5].mean(axis=1), shells[:, 5], np.ones(len(shells))]),
        ]
    )
    counts = np.maximum(1, np.floor(box / (np.prod(box) / max(len(features), 1)) ** (1 / 3))).astype(int)
    which, cell = _heard(features, counts, box / counts, sizes.size)
    order = np.argsort(cell, kind="stable")
    starts = np.r_[0, np.cumsum(np.bincount(cell, minlength=np.prod(counts)))]
    rows = features[which[order]].ravel()
    made = np.concatenate([[0, *counts, *(counts / box), HEAD, HEAD + len(starts), GROWTH], starts, rows])
    made[0] = len(made)
    return made


def _heard(features, counts, sides, size):
    """(feature, flat index of a cell) wherever in a cell a feature may ask for the least.

    From one cell down, each cut into eight: of thousands of features that reach all of the box few are heard in any
    small part of it, and only those go on.
    """
    which, place = np.arange(len(features)), np.zeros((len(features), 3), int)
    for halvings in range(int(np.ceil(np.log2(counts.max()))), -1, -1):
        many = -(-counts // 2**halvings)
        if many.max() > 1:
            which = np.repeat(which, len(CORNERS))
            place = (2 * place[:, None] + CORNERS).reshape(-1, 3)
            there = (place < many).all(axis=1)
            which, place = which[there], place[there]
        cell = np.ravel_multi_index(place.T, many)
        low = place * sides * 2**halvings
        least, most = _asked(features[which], low, low + sides * 2**halvings)
        loudest = np.full(np.prod(many), size)
        np.minimum.at(loudest, cell, most)
        kept = least <= loudest[cell] * (1 + CLOSE)
        which, place, cell = which[kept], place[kept], cell[kept]
    return which, cell


def _asked(features, low, high):
    """Least and most that features ask for in boxes, (n,) each."""
    center, radius, edge, shell = features[:, :3], features[:, 3], features[:, 4], features[:, 5] > 0
    near = np.linalg.norm(np.maximum(0.0, np.maximum(low - center, center - high)), axis=1) - radius
    far = np.linalg.norm(np.maximum(np.abs(low - center), np.abs(high - center)), axis=1) - radius
    # Inside of a ball nothing grows, inside of a shell to its centre.
    beyond = np.maximum(near, np.where(shell, -far, 0.0)), np.maximum(far, np.where(shell, -near, 0.0))
    return tuple(edge + GROWTH * np.maximum(0.0, each) for each in beyond)
