"""Inclusions that cannot matter: what leaving them out changes of the conductivity at most, a bound that is certain.

Let T' be the temperature of the body without the spheres S, K' its conductivity and e(B) the share of its energy in a
ball B. Around a sphere of S, of radius a and s times its surroundings' conductivity, T' is harmonic in every ball in
which that does not change. In one of radius b, where it is a sum of degrees l, put the exact solution of sphere and
surroundings that has T' on the ball's surface: the energy of degree l grows by ((2 l + 1)/l) x / (1 - x), with
x = alpha_l (a/b)^(2 l + 1), alpha_l = l (s - 1)/(l s + l + 1), which for b >= 2 a is most for l = 1, where alpha_1 is
Maxwell's polarisability beta = (s - 1)/(s + 2). With such balls apart this is a temperature that fits the load, so by
Dirichlet's principle K <= K' (1 + sum of 3 beta (a/b)^3 / (1 - beta (a/b)^3) e(b)). In the same way, with the flux of
T' on the ball's surface, Thomson's principle gives for s < 1
K >= K' / (1 + sum of 3 |beta| (a/b)^3 / (1 - 2 |beta| (a/b)^3) e(b)). Last, |grad T'|^2 is subharmonic: its mean over
a ball is at most that over a larger one about the same point, e(b) <= (b/R)^3 e(R), up to the radius R at which the
conductivity changes. What remains is 3 |beta| (a/R)^3 / (1 - 2 |beta| (a/b)^3) e(R), and shares sum to at most 1 where
balls are apart. Good spheres only raise K, poor ones only lower it: the larger of both sums counts. No gap between
other inclusions, however narrow or hot, enters: what the field is in S is bounded by the energy around it. What is no
sphere changes no more than the ball about it would, as K rises with the conductivity at every point.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from demheat.scene.inputs import finite
from demheat.scene.scene import Scene, check_scene
from demheat.scene.shapes.periodic import nearest

# Ball of the exact solution over the sphere at least: below degree 1 is not the most.
APART = 2.0
# Pairs of spheres looked at together.
BLOCK = 2**20


class Negligible(NamedTuple):
    """Inclusions that may be left out."""

    inclusions: tuple[int, ...]  # Their places in `Scene.inclusions`
    bound: float  # Relative change of the conductivity, at most, if all of them are left out
    scene: Scene  # Without them; the scene itself if there are none


def negligible(scene: Scene, accuracy: float) -> Negligible:
    """Inclusions without which the conductivity changes by less than an accuracy, whatever else is in the body.

    Parameters
    ----------
    scene : Scene
        With a conductivity: a periodic cell, or a box between two isothermal walls.
    accuracy : float
        Relative.

    Returns
    -------
    Negligible
        As many of the smallest as the bound allows: whole ones without a resistance on their surface, in surroundings
        that conduct, that hold nothing and whose next neighbours are at least a radius away from the balls about them.

    Raises
    ------
    ValueError
        If the accuracy is no number between 0 and 1.
    NotImplementedError
        If walls exchange heat with surroundings.

    Examples
    --------
    >>> from demheat import Material, Scene, Sphere
    >>> from demheat.scene.negligible import negligible
    >>> big, speck = (Sphere(c, r, Material(10.0)) for c, r in (((0.3, 0.5, 0.5), 0.2), ((0.9, 0.5, 0.5), 0.005)))
    >>> negligible(Scene((1.0, 1.0, 1.0), Material(1.0), [big, speck], gradient=(0, 1, 0)), 1e-3).inclusions
    (1,)
    """
    check_scene(scene)
    scene.require("what may be left out is known of the conductivity between temperatures", takes=("resistance",))
    finite("accuracy", accuracy, "a number between 0 and 1", lambda v: 0 < v < 1)
    radii, beta = _balls(scene)
    # What even in the widest ball alone is too much need not be looked at.
    widest = min(scene.size) / 2
    open_ = np.isfinite(beta) & (3 * np.abs(beta) * (radii / widest) ** 3 <= accuracy)
    for radius in np.unique(radii[open_])[::-1]:
        chosen, bound = _bound(scene, radii, beta, open_ & (radii <= radius))
        if chosen.any() and bound <= accuracy:
            left = tuple(shape for shape, out in zip(scene.inclusions, chosen, strict=True) if not out)
            numbers = tuple(np.flatnonzero(chosen).tolist())
            return Negligible(numbers, bound, replace(scene, inclusions=left))
    return Negligible((), 0.0, scene)


def change_without(scene: Scene, numbers: Sequence[int], least: float = 0.0) -> float:
    """By how much the conductivity changes, relatively and at most, without some inclusions; infinite if unknown."""
    if scene.anisotropic or scene.varies or scene.wall_exchanges or scene.wall_fluxes:
        return np.inf
    radii, beta = _balls(scene)
    chosen = np.zeros(len(radii), bool)
    chosen[list(numbers)] = True
    radii = np.where(chosen, np.maximum(radii, least), radii)
    if not np.all(np.isfinite(beta[chosen])):
        return np.inf
    kept, bound = _bound(scene, radii, beta, chosen)
    return bound if np.all(kept == chosen) else np.inf


def _balls(scene):
    """Radius and polarisability of the ball about each inclusion, NaN for what resists, has no end, or is in a pore."""
    k, parents = scene.conductivities, scene.parents()[1:]
    outer = k[parents]
    with np.errstate(invalid="ignore", divide="ignore"):
        beta = np.where(outer > 0, (k[1:] - outer) / (k[1:] + 2 * outer), np.nan)
    # Of spheres with a resistance other degrees may matter more than the first.
    radii = np.array([shape.ball()[1] for shape in scene.inclusions]).reshape(-1)
    beta[(scene.resistances[1:] > 0) | np.isinf(radii)] = np.nan
    return radii, beta


def _bound(scene, radii, beta, chosen):
    """Those of some balls that have room around them, and what leaving them out changes at most.

    One that holds another has no room: that is nearer to its middle than its own surface.
    """
    chosen = chosen.copy()
    while chosen.any():
        clear, apart = _room(scene, radii, chosen)
        ball = np.minimum(clear, radii[chosen] + apart / 2)
        tight = ball < APART * radii[chosen]
        if not tight.any():
            break
        chosen[np.flatnonzero(chosen)[tight]] = False
    if not chosen.any():
        return chosen, 0.0
    size, strength = radii[chosen], beta[chosen]
    change = 3 * np.abs(strength) * (size / clear) ** 3 / (1 - 2 * np.abs(strength) * (size / ball) ** 3)
    centers = _centers(scene)[chosen]
    sums = [_overlaps(centers, clear, np.where(sign * strength > 0, change, 0.0), scene.period) for sign in (1, -1)]
    return chosen, max(sums)


def _room(scene, radii, chosen):
    """Of each chosen ball the radius of its surroundings, and the least distance of its surface to another chosen."""
    centers, own = _centers(scene)[chosen], radii[chosen]
    if scene.periodic:
        clear = np.full(len(own), min(scene.size) / 2)
    else:
        clear = np.minimum(centers, np.array(scene.size) - centers).min(axis=1)
    for number in np.flatnonzero(~chosen):
        clear = np.minimum(clear, np.abs(scene.inclusions[number].sure_distance(centers, period=scene.period)))
    apart = np.full(len(own), np.inf)
    for rows in np.array_split(np.arange(len(own)), len(own) ** 2 // BLOCK + 1):
        gap = _distances(centers[rows], centers, scene.period) - own[rows, None] - own
        gap[np.arange(len(rows)), rows] = np.inf
        apart[rows] = gap.min(axis=1)
    return clear, apart


def _overlaps(centers, clear, change, period):
    """At most the sum of changes whose balls hold one point: of all balls that meet the worst one."""
    worst = 0.0
    for rows in np.array_split(np.arange(len(clear)), len(clear) ** 2 // BLOCK + 1):
        meet = _distances(centers[rows], centers, period) < clear[rows, None] + clear
        worst = max(worst, float((meet @ change).max(initial=0.0)))
    return worst


def _distances(some, centers, period):
    offsets = nearest(some[:, None] - centers[None], period)
    return np.sqrt(np.einsum("ijk,ijk->ij", offsets, offsets))


def _centers(scene):
    return np.array([shape.ball()[0] for shape in scene.inclusions]).reshape(-1, 3)
