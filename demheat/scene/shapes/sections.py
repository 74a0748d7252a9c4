"""What a plane leaves of a rectangular box, and the area in which it cuts it."""

import numpy as np

# A plane less inclined than this to an axis counts as parallel to it: rounding of the cubic pieces would be larger.
PARALLEL = 1e-6


def below(normals: np.ndarray, heights: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Part of boxes that lies behind planes, and the area of the planes within; exact.

    Source: Scardovelli and Zaleski, J. Comput. Phys. 164 (2000) 228-237.
    """
    widths = np.abs(normals) * sides
    total = widths.sum(axis=1)
    m = np.sort(widths / total[:, None], axis=1)
    m[m < PARALLEL] = 0.0
    m /= m.sum(axis=1, keepdims=True)
    depth = np.clip(0.5 - heights / total, 0.0, 1.0)
    part, slope = _part(np.minimum(depth, 1.0 - depth), *m.T)
    inside = (depth > 0) & (depth < 1)
    area = np.where(inside, slope * np.prod(sides) / total, 0.0)
    return np.where(depth > 0.5, 1.0 - part, part), area


def _part(depth, first, second, third):
    """Part of the unit cube below m . x = depth <= 1/2, m ascending and of sum 1, and its derivative."""
    pair, cube = first + second, 6.0 * first * second * third
    with np.errstate(divide="ignore", invalid="ignore"):
        pieces = [
            (depth < first, depth**3 / cube, 3 * depth**2 / cube),
            (
                depth < second,
                depth * (depth - first) / (2 * second * third) + first**2 / (6 * second * third),
                (2 * depth - first) / (2 * second * third),
            ),
            (
                depth < np.minimum(pair, third),
                (depth**2 * (3 * pair - depth) + first**2 * (first - 3 * depth) + second**2 * (second - 3 * depth))
                / cube,
                (3 * depth * (2 * pair - depth) - 3 * first**2 - 3 * second**2) / cube,
            ),
            (pair <= depth, (2 * depth - pair) / (2 * third), 1 / third),
        ]
        last = (
            (
                depth**2 * (3 - 2 * depth)
                + first**2 * (first - 3 * depth)
                + second**2 * (second - 3 * depth)
                + third**2 * (third - 3 * depth)
            )
            / cube,
            (6 * depth * (1 - depth) - 3 * (first**2 + second**2 + third**2)) / cube,
        )
        where = [where for where, _, _ in pieces]
        return (np.select(where, [piece[k] for piece in pieces], last[k - 1]) for k in (1, 2))
