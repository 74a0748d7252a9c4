"""How much of a body each of its phases is."""

from __future__ import annotations

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


def sampled_fractions(scene) -> np.ndarray:
    """The same by the phases at even points, right to a hundredth or so."""
    points = (0.5 + np.outer(np.arange(POINTS), STEPS)) % 1.0 * scene.size
    return np.bincount(scene.phase_at(points), minlength=len(scene.materials)) / POINTS


def known_fractions(scene) -> np.ndarray:
    """The same of an image, exact where that is known, else by sampling."""
    if scene.image is not None:
        return scene.image.fractions
    try:
        return fractions(scene)
    except NotImplementedError:
        return sampled_fractions(scene)
