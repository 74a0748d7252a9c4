"""What pores leave of a grid: bodies of conducting voxels, and which of them heat passes in a steady state.

Voxels are joined by faces that both sides' conductivities let pass, links by themselves: a cut voxel across an
insulating layer has none along its normal, and blocks.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from demheat.scene import Scene
from references.voxels import bodies_kernels as kernels
from references.voxels.links import links
from references.voxels.paint import Voxels, centers

# Of the largest component of a cut voxel's conductivity: less is rounding of a blocked direction.
BLOCKED = 1e-14
# Resistivity of pores over that of all that conducts, and a link's resistance at which it holds some of a pore.
POOR, HELD = 1e6, 1.001
# Voxels of one compiled call: a tenth of a second.
BLOCK = 1_000_000


class Bodies(NamedTuple):
    """Bodies of a grid; its walls, if it has some, are those across the first axis."""

    label: np.ndarray  # (nx, ny, nz) int32 array: Body of each voxel, -1 in pores
    # (n, 3) int16 array: Boxes by which each voxel, in flat order, is moved to where its body reaches it from its first
    # voxel
    shift: np.ndarray
    # (number of bodies,) bool array: Whether heat passes: from wall to wall, or in a periodic cell up the mean gradient
    passing: np.ndarray
    # low, high: (number of bodies,) bool arrays: Whether a body reaches the wall at either end of the first axis
    low: np.ndarray
    high: np.ndarray


def bodies(scene: Scene, voxels: Voxels, slope, *, linked: bool) -> Bodies:
    """Bodies of a scene on a grid."""
    below, first, last = (_linked if linked else _open)(scene, voxels)
    solid = voxels.conductivity[voxels.phase] > 0
    if len(voxels.cut) and not linked:
        solid.flat[voxels.cut] = voxels.tensor[:, :3].max(axis=1) > 0
    found, count = gathered(solid, below, scene.periodic, np.asarray(slope) * scene.size)
    low, high = np.zeros((2, count + 1), bool)
    if not scene.periodic:
        low[found.label[0][first]] = True
        high[found.label[-1][last]] = True
    low, high = low[:count], high[:count]
    passing = found.climbs[:count] if scene.periodic else low & high
    if len(voxels.cut) and not linked:
        _join_cut(found, voxels, count, scene.periodic)
    return Bodies(found.label, found.shift, passing, low, high)


def settle(found: Bodies, scene: Scene, temperature, slope, rise) -> None:
    """Give the bodies that no heat passes their temperature, and in periodic cells all their level, in place."""
    shape, count, label = temperature.shape, len(found.passing), found.label
    still = np.append(~found.passing, False)[label]
    x = np.meshgrid(*centers(shape, np.array(scene.size) / shape), indexing="ij", sparse=True)
    linear = sum(s * coordinate for s, coordinate in zip(slope, x, strict=True))
    if scene.periodic:
        jump = np.asarray(slope) * scene.size
        temperature[still] = -(np.broadcast_to(linear, shape)[still] + found.shift[still.ravel()] @ jump)
        inside = label >= 0
        body = label[inside]
        # Bodies whose voxels were all joined to others have none left.
        mean = np.bincount(body, temperature[inside], count) / np.maximum(np.bincount(body, minlength=count), 1)
        temperature[inside] -= mean[body]
        return
    level = np.where(found.low, 0.0, np.where(found.high, rise, np.nan))
    temperature[still] = level[label[still]] - np.broadcast_to(linear, shape)[still]


def _open(scene, voxels):
    """Faces below each voxel that both sides let pass, along the axes; voxels open to either wall."""
    below = []
    for axis in range(3):
        passes = voxels.conductivity[voxels.phase] > 0
        if len(voxels.cut):
            passes.flat[voxels.cut] = voxels.tensor[:, axis] > BLOCKED * voxels.tensor[:, :3].max(axis=1)
        if axis == 0:
            first, last = passes[0].copy(), passes[-1].copy()
        below.append(passes & np.roll(passes, 1, axis))
    return tuple(below), first, last


def _join_cut(found, voxels, count, periodic):
    """Let cut voxels that stand alone have the temperature of a whole one of their phase beside them."""
    label, shift, shape = found.label.reshape(-1), found.shift, found.label.shape
    is_cut, whole = np.zeros(label.size, bool), np.zeros(count + 1, bool)
    is_cut[voxels.cut] = True
    whole[label[~is_cut]] = True
    whole[-1] = False
    alone = voxels.cut[(label[voxels.cut] >= 0) & ~whole[label[voxels.cut]]]
    place, phase = np.stack(np.unravel_index(alone, shape)), voxels.phase.reshape(-1)
    for axis, step in ((axis, step) for axis in range(3) for step in (-1, 1)):
        there = place.copy()
        there[axis] += step
        wrapped = (there[axis] // shape[axis]).astype(np.int16)
        there[axis] %= shape[axis]
        other = np.ravel_multi_index(tuple(there), shape)
        fits = ~whole[label[alone]] & whole[label[other]] & (phase[other] == phase[alone]) & ~is_cut[other]
        fits &= periodic | (wrapped == 0)
        label[alone[fits]] = label[other[fits]]
        shift[alone[fits]] = shift[other[fits]]
        shift[alone[fits], axis] -= wrapped[fits]


def _linked(scene, voxels):
    """The same of links: those that no pore holds up."""
    conducting = np.where(scene.mean_conductivities > 0, 1.0, 1.0 / POOR)
    materials = [replace(material, conductivity=k) for material, k in zip(scene.materials, conducting, strict=True)]
    shapes = [replace(shape, material=new) for shape, new in zip(scene.inclusions, materials[1:], strict=True)]
    plain = replace(scene, matrix=materials[0], inclusions=shapes)
    found = links(plain, voxels.phase.shape, phase=voxels.phase)
    passes = [link > 1.0 / HELD for link in found]
    below = tuple(np.ascontiguousarray(np.delete(p, -1, axis)) for axis, p in enumerate(passes))
    return below, passes[0][0], passes[0][-1]


def gathered(solid, below, periodic, jump):
    """Bodies of solid voxels that open faces below them join, as the search finds them, and their number."""
    state = np.zeros(4, dtype=np.int64)
    found = kernels.Found(
        label=np.where(solid, np.int32(kernels.OPEN), np.int32(kernels.NONE)),
        shift=np.zeros((solid.size, 3), np.int16),
        climbs=np.zeros(solid.size, bool),
        queue=np.empty(solid.size, np.int32),
    )
    while kernels.gather(below, periodic, jump, found, state, BLOCK):
        pass
    return found, int(state[3])
