"""Random sequential addition: spheres put at random, one after the other, where they find room.

Source: Widom, J. Chem. Phys. 44 (1966) 3888.
"""

from __future__ import annotations

import numpy as np

# Jams near a volume fraction of 0.38; well before that nearly every trial is refused.
MOST_FILLED = 0.35
# Trials drawn at once, and those in a row after which a sphere has no room.
BATCH, TRIALS = 256, 200_000


def add_spheres(radii, size, rng, *, periodic: bool, margin=0.0, reuse: bool = False) -> np.ndarray:
    """Centres of spheres added at random where they overlap none that came before.

    Each trial is held against all spheres before it: fine for thousands.

    Parameters
    ----------
    radii : (n,) float array, m
        In the order of their turns.
    size : (3,) float array, m
        The box is [0, size].
    rng : numpy.random.Generator
    periodic : bool
        Whether spheres on opposite sides are neighbours.
    margin : float or (n,) float array, m
        Least distance of each centre from the faces.
    reuse : bool
        Give what is left of a batch of trials to the next spheres, which must then be equal: fewer trials, other
        places.

    Returns
    -------
    (n, 3) float array, m

    Raises
    ------
    RuntimeError
        If no room is found for a sphere.
    """
    margins, period = np.broadcast_to(margin, len(radii)), size if periodic else None
    centers, placed, failed = np.empty((len(radii), 3)), 0, 0
    while placed < len(radii):
        if failed * BATCH >= TRIALS:
            raise RuntimeError(f"no room for sphere {placed + 1} of {len(radii)} in {TRIALS} trials: ask for fewer")
        radius, edge, begin = radii[placed], margins[placed], placed
        trials = edge + (size - 2 * edge) * rng.random((BATCH, 3))
        for trial in trials[_free(trials, centers[:begin], radii[:begin] + radius, period)]:
            if placed == len(radii) or (placed > begin and not reuse):
                break
            if _free(trial[None], centers[begin:placed], radii[begin:placed] + radius, period)[0]:
                centers[placed] = trial
                placed += 1
        failed = 0 if placed > begin else failed + 1
    return centers


def _free(trials, centers, reach, period):
    """Which trials are no nearer to any centre than its reach, (t,) bool array."""
    square = np.zeros((len(trials), len(centers)))
    for axis in range(3):
        along = np.abs(trials[:, axis, None] - centers[:, axis])
        square += (along if period is None else np.minimum(along, period[axis] - along)) ** 2
    return np.all(square >= reach**2, axis=1)
