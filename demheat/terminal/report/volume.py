"""A scene and its fields as bytes on a regular grid, for the page's viewer."""

import base64
import zlib
from typing import NamedTuple

import numpy as np

from demheat.scene.bodies import inside

# Cells along the longest side, of the scene and of a field, which may be fitted at each; colours that the viewer tells
# apart.
CELLS, FIELD_CELLS, MOST = 112, 36, 16
NOTHING = 255


class Kinds(NamedTuple):
    """Where which conductivity is."""

    shape: tuple[int, int, int]
    content: str  # Packed bytes, the first axis fastest: a kind, or NOTHING beyond a round body
    conductivity: np.ndarray  # (k,) float array, W/(m K): Of each kind, the matrix first, the least of several alike


class Values(NamedTuple):
    """A field's values."""

    name: str
    unit: str
    shape: tuple[int, int, int]
    content: str  # Packed bytes: 0 where there is none, then from 1 to 255 from least to most
    least: float
    most: float


def kinds_of(scene) -> Kinds:
    """A scene's conductivities on a grid."""
    shape, points, within = _grid(scene, CELLS)
    k = scene.mean_conductivities
    kinds = np.array([k[0], *sorted(set(k.tolist()) - {k[0]})])
    # Of too many each stands for the next ones, too.
    kinds = kinds[np.unique(np.linspace(0, len(kinds) - 1, min(len(kinds), MOST)).astype(int))]
    order = np.argsort(kinds)
    place = order[np.searchsorted(kinds, k, sorter=order, side="right") - 1].astype(np.uint8)
    found = np.full(len(points), NOTHING, np.uint8)
    found[within] = place[scene.phase_at(points[within])]
    return Kinds(shape, _packed(found, shape), kinds)


def values_of(field) -> list[Values]:
    """Temperature and size of the flux of a field on a grid."""
    scene = field.scene
    shape, points, within = _grid(scene, FIELD_CELLS)
    found = []
    for name, unit, evaluate in (
        ("temperature", "K" if scene.periodic or scene.radiates else "K or °C", field.temperature_at),
        ("size of the flux", "W/m²", lambda at: np.linalg.norm(field.flux_at(at), axis=1)),
    ):
        values = np.full(len(points), np.nan)
        values[within] = evaluate(points[within])
        if not np.isfinite(values).any():
            continue
        # A few corners with a flux without bound would hide all else.
        least, most = np.nanmin(values), np.nanpercentile(values, 99.5 if "flux" in name else 100)
        part = np.clip((values - least) / ((most - least) or 1.0), 0.0, 1.0)
        content = np.where(np.isnan(part), 0, 1 + np.round(254 * np.nan_to_num(part))).astype(np.uint8)
        found.append(Values(name, unit, shape, _packed(content, shape), float(least), float(most)))
    return found


def _grid(scene, cells):
    """Shape of a grid of nearly cubic cells, their middles, and which lie in the body."""
    size = np.array(scene.size)
    shape = np.maximum(np.round(size / size.max() * cells), 1).astype(int)
    if scene.image is not None and max(scene.image.shape) <= cells:
        # Its own voxels in equal parts: no seams where others would cut them.
        shape = np.array(scene.image.shape) * (cells // max(scene.image.shape))
    middles = [(np.arange(count) + 0.5) / count * side for count, side in zip(shape, size, strict=True)]
    points = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 3)
    return tuple(shape.tolist()), points, inside(points, scene.domain, scene.size)


def _packed(content, shape):
    """Bytes as text, the first axis fastest."""
    return base64.b64encode(zlib.compress(content.reshape(shape).transpose().tobytes(), 9)).decode()
