"""Images as bodies: an array of labels, the edges of a voxel, and a material for each label."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Integral

import numpy as np

from demheat.scene.frozen import ReadOnly, read_only
from demheat.scene.inputs import LEAST, MOST, finite, moderate, vector
from demheat.scene.material import Material, check_material

# Phases are numbered in 16 bits, as on the grids of methods; voxels of one slab, which takes 8 bytes for each.
MOST_LABELS = 2**16
SLAB = 2**22
# More labels than these look like grey values.
LABELS = 16
GREY = (
    "grey values ask for a threshold first{}, from which on all are of one label, as `read_image` and files of scenes "
    "take it"
)
TYPES = (np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.int64)


@dataclass(frozen=True, eq=False, repr=False)
class Image:
    """A body of voxels, each wholly of the material of its label: `Scene.of_image(image, gradient=...)`.

    Parameters
    ----------
    labels : (nx, ny, nz) array of int or bool
        Read slab by slab, so it may be mapped from a file, or be an array in chunks that is read as NumPy's are, such
        as one of zarr; kept in the smallest type of integers that holds it.
    voxel : (3,) sequence of float, or float, m
        Edges of a voxel along x, y and z.
    materials : mapping of int to Material
        Of every label that there is; others are left out.

    Raises
    ------
    ValueError
        If an argument is not as described; the message names it, its value and what would be valid.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import Image, Material, Scene
    >>> labels = np.zeros((4, 4, 4), dtype=np.uint8)
    >>> labels[1:3] = 255
    >>> image = Image(labels, voxel=2e-6, materials={0: Material(0.2), 255: Material(2.0)})
    >>> image.fractions.tolist(), Scene.of_image(image, gradient=(1, 0, 0)).conductivities.tolist()
    ([0.5, 0.5], [0.2, 2.0])
    """

    labels: np.ndarray
    voxel: float | Sequence[float]
    materials: Mapping[int, Material]

    def __post_init__(self):
        labels = _checked_labels(self.labels)
        object.__setattr__(self, "voxel", _checked_voxel(self.voxel))
        if not all(map(moderate, self.size)):
            raise ValueError(f"Image.voxel = {self.voxel!r}: sides of the image must be from {LEAST:g} to {MOST:g} m")
        found = sorted(set().union(*(_occurring(slab) for _, slab in _read(labels))))
        object.__setattr__(self, "materials", ReadOnly(_checked_materials(self.materials, found)))
        kept = np.empty(labels.shape, _smallest(found[0], found[-1]))
        for part, slab in _read(labels):
            kept[part] = slab
        object.__setattr__(self, "labels", read_only(kept))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along each side."""
        return tuple(map(int, np.shape(self.labels)))

    @property
    def size(self) -> tuple[float, float, float]:
        """Sides of the body, m."""
        return tuple(n * h for n, h in zip(self.shape, self.voxel, strict=True))

    @property
    def phases(self) -> tuple[Material, ...]:
        """Materials in ascending order of their labels: index = phase number."""
        return tuple(self.materials.values())

    @cached_property
    def phase(self) -> np.ndarray:
        """Phase number of each voxel, (nx, ny, nz) uint8 or uint16 array that cannot be written to."""
        known = list(self.materials)
        if known == list(range(len(known))):
            return read_only(self.labels)
        phase = np.empty(self.shape, np.min_scalar_type(len(known) - 1))
        for part in slabs(self.shape):
            phase[part] = np.searchsorted(known, self.labels[part])
        return read_only(phase)

    def phase_on(self, shape: Sequence[int]) -> np.ndarray:
        """Phase number of each cell of a grid that splits voxels into equal parts, (shape) uint8 or uint16 array."""
        phase = self.phase
        for axis, (n, own) in enumerate(zip(shape, self.shape, strict=True)):
            phase = np.repeat(phase, n // own, axis) if n > own else phase
        return phase

    def cropped(self, low: Sequence[int], high: Sequence[int]) -> Image:
        """The voxels from low to below high along each axis, a body of its own.

        Parameters
        ----------
        low, high : (3,) sequence of int

        Returns
        -------
        Image

        Raises
        ------
        ValueError
            If they are not whole numbers with 0 <= low < high <= shape along each axis.
        """
        ends = list(zip(low, high, self.shape, strict=False))
        whole = all(isinstance(each, Integral) for end in ends for each in end)
        if len(ends) != 3 or not whole or not all(0 <= a < b <= n for a, b, n in ends):
            sides = " x ".join(map(str, self.shape))
            raise ValueError(
                f"low = {low!r}, high = {high!r}: must be whole numbers, 0 <= low < high, within {sides} voxels"
            )
        return replace(self, labels=self.labels[tuple(slice(a, b) for a, b, _ in ends)])

    @cached_property
    def fractions(self) -> np.ndarray:
        """Volume fraction of each phase, (number of phases,) float array."""
        count = sum(np.bincount(self.phase[part].ravel(), minlength=len(self.phases)) for part in slabs(self.shape))
        return read_only(count / math.prod(self.shape))

    def phase_at(self, points: np.ndarray, *, periodic: bool) -> np.ndarray:
        """Phase number at points, those of the nearest voxel where they lie beyond the body.

        Parameters
        ----------
        points : (n, 3) float array, m
        periodic : bool
            The image is repeated all round.

        Returns
        -------
        (n,) int array
        """
        index = np.floor(points / self.voxel)
        last = np.array(self.shape)
        index = index % last if periodic else np.clip(index, 0, last - 1)
        return self.phase[tuple(index.astype(np.int64).T)].astype(np.int32)

    def turned(self, order: Sequence[int]) -> Image:
        """The same image with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        voxel = tuple(self.voxel[axis] for axis in order)
        materials = {label: material.turned(order) for label, material in self.materials.items()}
        return replace(self, labels=self.labels.transpose(order), voxel=voxel, materials=materials)

    @cached_property
    def digest(self) -> str:
        """Text that tells the labels and their shape from others'."""
        found = hashlib.sha256(repr((self.shape, self.labels.dtype.str)).encode())
        for part in slabs(self.shape):
            found.update(np.ascontiguousarray(self.labels[part]).tobytes())
        return found.hexdigest()

    def __eq__(self, other):
        if not isinstance(other, Image):
            return NotImplemented
        alike = self.voxel == other.voxel and self.materials == other.materials
        return alike and np.array_equal(self.labels, other.labels)

    def __hash__(self):
        return hash((self.shape, self.voxel))

    def __repr__(self):
        sides = " x ".join(map(str, self.shape))
        return f"Image({sides} voxels of {self.voxel} m, labels {', '.join(map(str, self.materials))})"


def slabs(shape: Sequence[int]) -> Iterator[slice]:
    """Slices along the first axis of an array, of some millions of elements each."""
    thick = _thickness(shape)
    return (slice(start, start + thick) for start in range(0, shape[0], thick))


def _thickness(shape):
    return max(1, SLAB // max(1, math.prod(shape[1:])))


def _read(labels):
    """Slabs of labels and where they lie; of an array in chunks each is read once, a layer of them at a time."""
    chunk = getattr(labels, "chunks", None) or (1,)
    layer = chunk[0] if isinstance(chunk[0], Integral) else 1
    thick = layer * max(1, _thickness(labels.shape) // layer)
    for start in range(0, labels.shape[0], thick):
        whole = np.asarray(labels[start : start + thick])
        for part in slabs(whole.shape):
            slab = whole[part]
            yield slice(start + part.start, start + part.start + len(slab)), slab


def _smallest(low, high):
    """The smallest type of integers between two."""
    return next(kind for kind in TYPES if np.iinfo(kind).min <= low and high <= np.iinfo(kind).max)


def _checked_labels(labels):
    """An array of labels as it is given, or ValueError; one in chunks is not read here."""
    try:
        labels = labels if isinstance(getattr(labels, "dtype", None), np.dtype) else np.asarray(labels)
    except ValueError:
        raise ValueError("Image.labels: rows of unlike lengths; must be an (nx, ny, nz) array") from None
    if labels.ndim != 3 or not math.prod(labels.shape):
        raise ValueError(f"Image.labels of shape {labels.shape}: must be (nx, ny, nz), of one voxel or more")
    if np.ma.is_masked(labels) or labels.dtype.kind not in "iub":
        kind = "masked" if np.ma.is_masked(labels) else labels.dtype
        raise ValueError(
            f"Image.labels of type {kind}: must be whole numbers, one for each material; {GREY.format('')}"
        )
    return labels


def _checked_voxel(voxel):
    valid = "a finite number of metres, or three of them"
    edges = (finite("Image.voxel", voxel, valid),) * 3 if np.ndim(voxel) == 0 else vector("Image.voxel", voxel)
    if not min(edges) > 0:
        raise ValueError(f"Image.voxel = {voxel!r}: all edges must be > 0 m")
    return edges


def _checked_materials(materials, found):
    """Materials of the labels that there are, in ascending order."""
    if not isinstance(materials, Mapping):
        raise ValueError(f"Image.materials = {materials!r}: must map each label to a Material")
    for label, material in materials.items():
        if not isinstance(label, Integral):
            raise ValueError(f"Image.materials: label {label!r} must be a whole number")
        check_material(f"Image.materials[{label}]", material)
        if material.perfect:
            raise ValueError(f"Image.materials[{label}] = {material}: must have a finite conductivity in an image")
    if len(found) > MOST_LABELS:
        raise ValueError(f"Image.labels: {len(found)} different ones; must be at most {MOST_LABELS}")
    lacking = [label for label in found if label not in materials]
    if lacking:
        more = f" and {len(lacking) - 8} more" if len(lacking) > 8 else ""
        middle = f", such as threshold = {(found[0] + found[-1] + 1) // 2}"
        grey = f"; {GREY.format(middle)}" if len(found) > LABELS else ""
        raise ValueError(
            f"Image.materials: none for labels {', '.join(map(str, lacking[:8]))}{more} of the image; must have one "
            f"for each{grey}"
        )
    return {label: materials[label] for label in found}


def _occurring(slab):
    """Labels of a slab, a set of int."""
    most = np.iinfo(np.int64).max
    if slab.dtype.kind == "u" and slab.max() > most:
        raise ValueError(f"Image.labels: {slab.max()} is the largest; must be at most {most}")
    slab = slab.astype(np.int64)
    low = int(slab.min())
    if int(slab.max()) - low < MOST_LABELS:
        # Without sorting millions.
        return set((np.flatnonzero(np.bincount((slab - low).ravel())) + low).tolist())
    return set(np.unique(slab).tolist())
