"""Inclusions that have come off from what they lie in."""

from dataclasses import replace

import numpy as np

from demheat.scene import Scene, check_scene
from demheat.scene.inputs import finite, moderate, whole
from demheat.scene.material import WITHIN


def drawn(count: int, share: float, seed: int, name: str = "share") -> np.ndarray:
    """A share of so many things, drawn at random; what a larger share draws holds what a smaller one does."""
    share = finite(name, share, "a number from 0 to 1", lambda v: 0 <= v <= 1)
    order = np.random.default_rng(whole("seed", seed, "an integer >= 0", lambda v: v >= 0)).permutation(count)
    found = np.zeros(count, bool)
    found[order[: round(share * count)]] = True
    return found


def debonded(scene: Scene, share: float, *, seed: int, resistance: float | None = None) -> Scene:
    """A scene in which a share of the inclusions, drawn at random, has come off.

    Parameters
    ----------
    scene : Scene
    share : float
        Of the inclusions that lie in the matrix, from 0 to 1; what lies in one of them comes off with it. With one seed
        a larger share is the same draw and more.
    seed : int
        Of NumPy's default generator.
    resistance : float, m2 K/W, optional
        That of their surfaces from now on, in place of a smaller one. By default no heat passes: in a steady state that
        is a pore, which all methods take that take pores, and the inclusion's own conductivity does not matter.

    Returns
    -------
    Scene

    Raises
    ------
    ValueError
        If an argument is not as described.

    Examples
    --------
    >>> from demheat import damage, gallery
    >>> composite = gallery.random_dispersion(8, diameter=0.3, seed=1, edge=1.0)
    >>> off = damage.debonded(composite, 0.5, seed=0)
    >>> int((off.conductivities == 0).sum())
    4
    """
    check_scene(scene)
    if resistance is not None:
        valid = f"None or a finite number > 0 m2 K/W{WITHIN}"
        resistance = finite("resistance", resistance, valid, lambda v: v > 0 and moderate(v))
    parents = scene.parents()
    outermost = np.flatnonzero(parents[1:] == 0)
    off = np.zeros(len(scene.inclusions) + 1, bool)
    off[1 + outermost[drawn(len(outermost), share, seed)]] = True
    if resistance is not None:
        changed = [
            replace(each, resistance=max(each.resistance, resistance)) if own else each
            for each, own in zip(scene.inclusions, off[1:], strict=True)
        ]
        return replace(scene, inclusions=changed)
    # An inclusion comes after the one that it lies in.
    for phase in range(1, len(off)):
        off[phase] |= off[parents[phase]]
    changed = [_pore(each) if own else each for each, own in zip(scene.inclusions, off[1:], strict=True)]
    return replace(scene, inclusions=changed)


def _pore(shape):
    """The same shape without conductivity: its surface need not resist besides."""
    return replace(shape, material=replace(shape.material, conductivity=0.0), resistance=0.0)
