"""What links carry across gaps too narrow for twins: what the gap lets pass, by its width and the surfaces' curvatures.

Where two bodies nearly touch in a point, no twins stand in the disc about it in which the gap is narrower than some
`least` width. Beside the disc they do, and their cells, which reach over it, conduct as a gap of that width would. The
gap conducts what rings of radius r do that are h + r^2/(2 R) wide, and in the middle what draws together in the bodies
(`demheat.network.gap_law`, from Batchelor and O'Brien, Proc. R. Soc. A 355 (1977) 313). What that is more than cells
have is shared by the facets between the two bodies, slivers at the rim of the disc and few within it, whatever their
area.
Between surfaces that are parallel, along a line at least, facets between the bodies fill the gap: each has its own way.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.network.gap_law import gap_conductance
from demheat.network.narrowest import narrowest

# Of the larger curvature: less than this is none, and the gap as wide along a line.
LINE = 1e-3
# Of a gap's width: what its bend adds at the rim, if it counts as even.
EVEN = 1e-3
# Of what a gap resists, at least that is its own, and not how heat spreads in the bodies beyond it.
LEAST = 0.3


class Facets(NamedTuple):
    """Facets over one gap."""

    points: np.ndarray  # (n, 3) float array, m: On the facets, as seen from one copy of the first body
    area: np.ndarray  # (n,) float array, m2
    between: Callable  # See `narrowest`
    medium: float  # W/(m K): Of what lies in the gap
    resistivity: float  # m K/W: 1/k of the one body and of the other
    resistance: float  # m2 K/W: Of the surfaces
    taken: np.ndarray  # (2, n) float array, W/K: What passes from the particle on either side into its body


def across(conductance, facets, least):
    """Conductance of each facet over a gap, (n,) float array, W/K, and how wide the gap is, m; NaN if it is not known.

    conductance : (n,) float array, W/K; of the facets if nothing lies in the gap but what surfaces resist
    least : float, m; width of a gap that has twins
    """
    points, area, between, medium, resistivity, resistance, taken = facets
    one, two = between(points)[0]
    gap = narrowest(between, points[np.argmin(one + two)], least)
    if gap is None:
        return _in_series(conductance, _alone(np.maximum(one + two, 0.0), area, medium)), np.nan
    square = ((points - gap.place) @ gap.along.T) ** 2
    large, small = gap.curvatures
    if large * area.sum() <= EVEN * gap.width or large == 0:
        own = _alone(gap.width + 0.5 * square @ gap.curvatures, area, medium)
        return _in_series(conductance, own), gap.width
    if small <= LINE * large:
        own = _beside_a_line(gap.width, large, np.sqrt(square[:, 0]), area, medium)
        return _in_series(conductance, own), gap.width
    # What surfaces resist is as much more of the matrix.
    thicker = resistance * medium
    more = _beyond_twins(gap.width + thicker, 1.0 / np.sqrt(large * small), medium, resistivity, least + thicker)
    # What passes from a particle into its body says how much of it it takes: some cells are slivers.
    with np.errstate(divide="ignore"):
        way = 1.0 / (1.0 / taken).sum(axis=0)
    return medium * area / (least + thicker) + more * way / max(float(way.sum()), 1e-300), gap.width


def _in_series(one, two):
    with np.errstate(divide="ignore"):
        return 1.0 / (1.0 / one + 1.0 / two)


def _beyond_twins(width, radius, medium, resistivity, least):
    """Conductance of the disc in which a gap has no twins, less that of a gap as wide as at its rim all over."""
    wide = least - width
    if wide <= 0:
        return 0.0
    disc = np.sqrt(2.0 * radius * wide)
    whole = float(gap_conductance(width, 0.0, disc, radius, resistivity, medium))
    # That is from afar to afar: beyond the disc heat spreads in the bodies as the network has it.
    whole /= max(1.0 - whole * resistivity / (2.0 * np.pi * disc), LEAST)
    return max(whole - 2.0 * np.pi * radius * medium * wide / least, 0.0)


def _alone(width, area, medium):
    return np.divide(medium * area, width, out=np.full(len(area), np.inf), where=width > 0)


def _beside_a_line(width, curvature, offset, area, medium):
    """By the mean of 1/(h + c x^2/2) over what each facet is wide."""
    half, scale = 0.5 * np.sqrt(area), np.sqrt(max(2.0 * width / curvature, 1e-300))
    turn = np.arctan((offset + half) / scale) - np.arctan((offset - half) / scale)
    return medium * area * turn / (half * scale * curvature)
