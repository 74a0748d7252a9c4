"""What is made of an image before it is a body: a part of it, fewer and larger voxels, labels out of grey values."""

import warnings

import numpy as np

from demheat.scene.image import slabs
from demheat.scene.inputs import whole

CROP = "three pairs of whole numbers [first, beyond], in voxels of the image"
LEVELS = "a finite number, or several that rise: below the first all is label 0, from the first on 1, and so on"


def changed(values, *, crop=None, coarsen=1, threshold=None):
    """An array cropped, then coarsened (the mean of grey values, of labels the most frequent), then told apart."""
    if crop is not None:
        values = values[tuple(slice(*ends) for ends in _checked_crop(crop, values.shape))]
    whole("coarsen", coarsen, "a whole number >= 1", lambda v: v >= 1)
    levels = None if threshold is None else _checked_levels(threshold)
    if any(n % coarsen for n in values.shape):
        sides = " x ".join(map(str, values.shape))
        raise ValueError(f"coarsen = {coarsen}: must divide the {sides} voxels; crop cuts some off")
    if coarsen == 1 and levels is None:
        return values
    made = np.empty([n // coarsen for n in values.shape], values.dtype if levels is None else np.uint8)
    for part in slabs(made.shape):
        own = np.asarray(values[part.start * coarsen : min(part.stop, len(made)) * coarsen])
        if levels is None:
            made[part] = _most(own, coarsen)
        else:
            made[part] = np.searchsorted(levels, own if coarsen == 1 else _blocks(own, coarsen).mean(axis=-1), "right")
    if levels is not None:
        _warn_of_one(made, values, threshold)
    return made


def _warn_of_one(labels, values, threshold):
    """A threshold that tells nothing apart is a slip, mostly: of another depth of grey."""
    first = labels.flat[0]
    if labels.size > 1 and np.all(labels == first):
        warnings.warn(
            f"threshold = {threshold!r}: all {labels.size} voxels are of label {first}, as grey values are "
            f"{values.min()} to {values.max()}",
            stacklevel=2,
        )


def _blocks(values, coarsen):
    """Values of each block in a row, (nx, ny, nz, coarsen^3) array."""
    a, b, c = (n // coarsen for n in values.shape)
    parts = values.reshape(a, coarsen, b, coarsen, c, coarsen)
    return parts.transpose(0, 2, 4, 1, 3, 5).reshape(a, b, c, -1)


def _most(labels, coarsen):
    """The label that most voxels of each block have; of several the least."""
    blocks = np.sort(_blocks(labels, coarsen), axis=-1)
    best, count = blocks[..., 0].copy(), np.zeros(blocks.shape[:3], int)
    run = np.ones(blocks.shape[:3], int)
    for k in range(1, blocks.shape[-1] + 1):
        ends = np.full(run.shape, True) if k == blocks.shape[-1] else blocks[..., k] != blocks[..., k - 1]
        better = ends & (run > count)
        best[better], count[better] = blocks[..., k - 1][better], run[better]
        run = np.where(ends, 1, run + 1)
    return best


def _checked_crop(crop, shape):
    try:
        ends = np.array(crop)
        good = ends.dtype.kind in "iu" and ends.shape == (3, 2)
    except ValueError:
        good = False
    if not good or any(not 0 <= a < b <= n for (a, b), n in zip(ends.tolist(), shape, strict=True)):
        raise ValueError(f"crop = {crop!r}: must be {CROP}, within {' x '.join(map(str, shape))}")
    return ends.tolist()


def _checked_levels(threshold):
    try:
        levels = np.atleast_1d(np.array(threshold, dtype=float))
    except (TypeError, ValueError):
        levels = np.empty(0)
    good = levels.ndim == 1 and 0 < len(levels) < 255 and np.all(np.isfinite(levels)) and np.all(np.diff(levels) > 0)
    if not good:
        raise ValueError(f"threshold = {threshold!r}: must be {LEVELS}")
    return levels
