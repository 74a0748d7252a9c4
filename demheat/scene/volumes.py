"""How much of a body each of its phases is, and how thin: inclusions, and the coats that others within them leave."""

import numpy as np

# Points at which phases are asked for where volumes have no closed form, and steps of an even sequence of them (Roberts
# 2018): powers of the inverse of the root of x^4 = x + 1.
POINTS = 1024
STEPS = 1.2207440846057596 ** -np.arange(1.0, 4.0)


def fractions(scene) -> np.ndarray:
    """Exact volume fraction of each phase, (1 + number of inclusions,) float array."""
    volumes = np.append(scene.volume, [s.volume_in(scene.size, periodic=scene.periodic) for s in scene.inclusions])
    # The innermost inclusion around each, or the matrix, gives up the place.
    np.subtract.at(volumes, scene.parents()[1:], volumes[1:].copy())
    return volumes / scene.volume


def sampled_fractions(scene, count: int = POINTS) -> np.ndarray:
    """The same by the phases at even points, right to a hundredth or so."""
    points = (0.5 + np.outer(np.arange(count), STEPS)) % 1.0 * scene.size
    return np.bincount(scene.phase_at(points), minlength=len(scene.materials)) / count


def known_fractions(scene) -> np.ndarray:
    """The same of an image, exact where that is known, else by sampling."""
    if scene.image is not None:
        return scene.image.fractions
    try:
        return fractions(scene)
    except NotImplementedError:
        return sampled_fractions(scene)


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
