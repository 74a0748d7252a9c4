"""How thin the inclusions of a scene are, and the coats that inclusions within them leave: what a grid may not see."""

from __future__ import annotations

import numpy as np


def extents(scene) -> np.ndarray:
    """Least length of each inclusion along the axes, (number of inclusions,) float array, m."""
    return np.array([_least(shape.bounds()) for shape in scene.inclusions])


def narrower(scene, lengths) -> np.ndarray:
    """Whether each inclusion is narrower along some axis than a length, (number of inclusions,) bool array.

    Parameters
    ----------
    scene : Scene
    lengths : (3,) float array, m
        Along each axis.
    """
    bounds = [shape.bounds() for shape in scene.inclusions]
    return np.array([bool(np.any(high - low < lengths)) for low, high in bounds], bool)


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


def _least(bounds):
    low, high = bounds
    ends = np.isfinite(low)
    return float(np.min(high[ends] - low[ends], initial=np.inf))
