"""How thin the inclusions of a scene are, and the coats that inclusions within them leave: what a grid may not see."""

from __future__ import annotations

import numpy as np


def extents(scene) -> np.ndarray:
    """Least width of each inclusion, (number of inclusions,) float array, m."""
    return np.array([shape.width for shape in scene.inclusions])


def narrower(scene, lengths) -> np.ndarray:
    """Whether each inclusion is narrower along some axis than a length, (number of inclusions,) bool array.

    Or in any direction than the least of the lengths, where it is known to be.
    """
    along = np.array([high - low for low, high in (shape.bounds() for shape in scene.inclusions)]).reshape(-1, 3)
    return np.any(along < lengths, axis=1) | (extents(scene) < np.min(lengths))


def coats(scene) -> np.ndarray:
    """What is left of each inclusion around one that lies in it, (number of inclusions,) float array, m.

    The widest place of it, along the axes: a coat as thin as that is thin all round. Infinite without one in it.
    """
    left = np.full(len(scene.inclusions), np.inf)
    parents = scene.parents()[1:]
    for number in np.flatnonzero(parents):
        outer = parents[number] - 1
        (low, high), (start, stop) = scene.inclusions[outer].bounds(), scene.inclusions[number].bounds()
        ends = np.isfinite(low) & np.isfinite(start)
        gaps = np.stack([start[ends] - low[ends], high[ends] - stop[ends]])
        if scene.periodic:
            # The image whose middle is nearest.
            turns = np.round((gaps[0] - gaps[1]) / 2 / np.array(scene.size)[ends]) * np.array(scene.size)[ends]
            gaps += np.stack([-turns, turns])
        left[outer] = min(left[outer], gaps.max(initial=-np.inf) if gaps.size else np.inf)
    return left
