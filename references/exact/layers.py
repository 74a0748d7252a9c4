"""Plane layers of tensors: the gradient along them and the flux across them are the same in all.

With the normal n and c = n.K g, the same in every layer, the gradient across is (c - n.K g_t) / n.K n there, g_t the
gradient along; the mean over the layers, and what their surfaces resist, fix c.
"""

import numpy as np

from demheat.scene import Layer
from references.exact.forms import SAME, Closed, mean_load, pieces


def tensor_laminate(scene):
    """A homogeneous box or plane layers of tensors, in a periodic cell; between walls where heat runs straight."""
    load = mean_load(scene, np.full(3, np.nan)) if scene.only(Layer) else None
    if load is None or not scene.mean_conductivities.all():
        return None
    gradient, level = load
    normal = scene.inclusions[0].axis if scene.inclusions else 0
    breaks, phase, resist = pieces(scene, normal)
    tensors, thickness, length = scene.tensors[phase], np.diff(breaks), breaks[-1]
    slopes, across = _gradients(thickness, tensors, normal, gradient, resist[1:].sum())
    fluxes = -np.einsum("nij,nj->ni", tensors, slopes)
    if not scene.periodic and _bent(scene, slopes, fluxes):
        return None
    rise = np.concatenate([[0.0], np.cumsum(slopes[:, normal] * thickness)])
    jumps = across * np.cumsum(resist)[:-1]
    sideways = np.where(np.arange(3) == normal, 0.0, gradient)

    def where(points):
        turns = np.floor(points[:, normal] / length) if scene.periodic else np.zeros(len(points))
        x = points[:, normal] - turns * length
        return turns, x, np.clip(np.searchsorted(breaks, x, side="right") - 1, 0, len(phase) - 1)

    def temperature(points):
        turns, x, piece = where(points)
        total = turns * gradient[normal] * length + np.interp(x, breaks, rise) + jumps[piece]
        return level + points @ sideways + total

    mean = thickness @ fluxes / length
    form = "laminate of tensors" if scene.inclusions else "homogeneous tensor"
    stats = {"unknowns": len(phase), "digits": 14.0}
    return Closed(form, temperature, lambda points: fluxes[where(points)[2]], mean, normal, breaks, stats)


def _gradients(thickness, tensors, normal, gradient, resistance):
    """Gradient in each layer, (n, 3) float array, and n.K g."""
    along = np.where(np.arange(3) == normal, 0.0, gradient)
    own, beside = tensors[:, normal, normal], tensors[:, normal] @ along
    whole = gradient[normal] * thickness.sum() + thickness @ (beside / own)
    across = whole / (thickness @ (1.0 / own) + resistance)
    slopes = np.tile(along, (len(own), 1))
    slopes[:, normal] = (across - beside) / own
    return slopes, across


def _bent(scene, slopes, fluxes):
    """Whether insulated or isothermal walls would bend what is the same all along the layers."""
    axis = next("xyz".index(name[0]) for name in scene.walls)
    return any(np.abs(np.delete(each, axis, axis=1)).max() > SAME * np.abs(each).max() for each in (slopes, fluxes))
