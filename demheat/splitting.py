"""How far an answer on the voxels of an image may be off: by the same with each voxel split, on a part of the image.

An image has no coarser voxels to compare with, that would be another body; but finer ones are the same body. Of a large
image a block out of its middle is split, and what that changes there, in parts of the block's conductivity, counts for
all of it.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.error import ROUNDING, Estimate, conductivity_of, quietly
from demheat.scene import Scene
from demheat.scene.boards import left_by_boards

# On boards of contrast 10 to 1000, blocks of 1 to 32 voxels, Eyre and Milton's scheme asks for up to 1.02 times what
# the power of the field at corners says where that counts, links and elements for less.
BOARDS = 1.1


class Splitting(NamedTuple):
    """How a method's error on an image is read off split voxels."""

    most: int  # Voxels of the image, of the block that is split
    safety: float  # What the change is raised by


def by_splitting(field, again: Callable, rule: Splitting) -> Estimate:
    """The estimate of a method on an image; `again(scene, parts)` makes a field of another image, its voxels split."""
    scene, k = field.scene, conductivity_of(field)
    block = block_of(scene, rule.most)
    own = field if block is scene else quietly(lambda parts: again(block, parts), 1)
    finer = quietly(lambda parts: again(block, parts), 2)
    scale = float(np.linalg.norm(own.mean_flux))
    if not scale and np.any(field.mean_flux):
        raise NotImplementedError("Field.error: no heat passes the block in the middle of the image that was looked at")
    safety = max(rule.safety, BOARDS * left_by_boards(block, goes_on=scene.periodic and block is scene))
    part = safety * float(np.linalg.norm(finer.mean_flux - own.mean_flux)) / scale if scale else 0.0
    part += field.stats["residual"] + ROUNDING
    half = part * abs(k)
    how = "voxels split in two" + ("" if block is scene else f", of a block of {_words(block.image.shape)}")
    flux = part * float(np.linalg.norm(field.mean_flux))
    return Estimate(how, max(k - half, 0.0), k + half, flux, math.nan, (k, conductivity_of(finer)))


def block_of(scene: Scene, most: int) -> Scene:
    """The scene, or as much of its image out of the middle as so many voxels are, under the same load."""
    image, counts = scene.image, np.array(scene.image.shape)
    while counts.prod() > most:
        counts[np.argmax(counts)] = -(-counts.max() // 2)
    if counts.prod() == math.prod(image.shape):
        return scene
    low = (np.array(image.shape) - counts) // 2
    part = image.cropped(low.tolist(), (low + counts).tolist())
    return Scene.of_image(part, gradient=scene.gradient, walls=scene.walls)


def _words(shape):
    return " x ".join(map(str, shape))
