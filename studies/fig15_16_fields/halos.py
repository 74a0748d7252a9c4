"""The exact field averaged over halos, as the fluxes of particles are: what a halo alone does to a flux."""

import numpy as np

# Irrational numbers whose multiples fill an interval evenly; two, so that angle and radius are not alike.
GOLDEN, PLASTIC = (5**0.5 - 1) / 2, 0.7548776662466927
# Beside the sphere a mean of so many is off by .1 %.
POINTS = 5_000


def ball(number=POINTS):
    """Points that fill a ball of radius 1 evenly, (number, 3) float array."""
    k = np.arange(number)
    height = 1 - (2 * k + 1) / number
    across, turn = np.sqrt(1 - height**2), 2 * np.pi * GOLDEN * k
    radius = np.cbrt(PLASTIC * k % 1.0)
    return radius[:, None] * np.column_stack((across * np.cos(turn), across * np.sin(turn), height))


def averaged(field, places, radii):
    """Flux down the load at points, averaged over halos that end at the walls."""
    size, axis, found = np.array(field.scene.size), field.scene.axis, {}
    for letter, place in places.items():
        means = []
        for radius in radii:
            points = place * size + radius * ball()
            points = points[np.all((points > 0) & (points < size), axis=1)]
            means.append(float(-field.flux_at(points)[:, axis].mean()))
        found[letter] = means
    return found
