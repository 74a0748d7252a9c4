"""Images of labels from files: NumPy, TIFF, raw bytes with a MetaImage header, NRRD, zarr.

=========== ====================================================================================================
suffix      what is read
=========== ====================================================================================================
.npy        an (nx, ny, nz) array, mapped into memory
.tif .tiff  a stack of pages of one channel: columns are x, rows y, pages z; mapped if neither packed nor in pieces
.mhd .mha   MetaImage: a header as text, with the raw bytes in a file of their own or behind it, x fastest; mapped
.nrrd .nhdr as pynrrd reads it, x fastest
.zarr       a folder with one (nx, ny, nz) array, read a layer of chunks at a time; or an OME-Zarr image, by its axes
=========== ====================================================================================================

MetaImages and NRRDs, and TIFFs as ImageJ and OME write them, may tell the edges of a voxel. On request a part is cut
out, voxels are made fewer and larger, and grey values are told apart by thresholds: `changed`.

What is mapped or in chunks passes slab by slab into the smallest type that holds the labels. What is packed is unpacked
no further than the header's shape needs: `packed`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from demheat.io.images import nrrd, raw, tiff, zarr
from demheat.io.images.changed import changed
from demheat.io.images.source import check_there
from demheat.runtime.limits import check_free
from demheat.runtime.paths import checked_path
from demheat.scene import Image, Material

# What a folder is called that zarr reads.
CHUNKED = ".zarr"


def read_image(
    path,
    *,
    materials: Mapping[int, Material],
    voxel=None,
    crop: Sequence[Sequence[int]] | None = None,
    coarsen: int = 1,
    threshold: float | Sequence[float] | None = None,
) -> Image:
    """Read an image.

    Parameters
    ----------
    path : path
        Its suffix tells the format.
    materials : mapping of int to Material
        Of each label.
    voxel : (3,) sequence of float, or float, m, optional
        Edges of a voxel of the file; needed unless the file tells them.
    crop : (3, 2) sequence of int, optional
        First voxel and the one beyond the last along x, y and z.
    coarsen : int
        So many voxels along each axis become one: of grey values their mean, of labels the most frequent.
    threshold : float or sequence of float, optional
        Of grey values: below the first is label 0, from the first on label 1, from the second on label 2, ...

    Returns
    -------
    Image

    Raises
    ------
    ValueError
        If the file is none of these, or broken, or does not fit into memory; or as `Image`. One line with the path.
    ImportError
        If a library that the format needs is not installed.

    Examples
    --------
    >>> import tempfile, numpy as np
    >>> from pathlib import Path
    >>> from demheat import Material
    >>> from demheat.io import images, scenes
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(Path(folder, "rock.npy"), np.arange(8).reshape(2, 2, 2) % 2)
    ...     image = images.read_image(
    ...         Path(folder, "rock.npy"), voxel=5e-6, materials={0: Material(0.2), 1: Material(2.0)}
    ...     )
    >>> image.shape, image.fractions.tolist()
    ((2, 2, 2), [0.5, 0.5])
    """
    path = checked_path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        beside = path.with_suffix(".mhd")
        hint = f"; raw bytes need a header, such as {beside.name}" if path.suffix.lower() == ".raw" else ""
        raise ValueError(f"{path}: must end in one of {', '.join(READERS)}{hint}")
    check_there(path, folder=path.suffix.lower() == CHUNKED)
    try:
        labels, own = reader(path)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    if voxel is None and own is None:
        raise ValueError(f"{path}: does not tell the edges of a voxel; voxel must be given, in metres")
    try:
        labels = changed(labels, crop=crop, coarsen=coarsen, threshold=threshold)
        check_free(path, math.prod(labels.shape) * min(labels.dtype.itemsize, 2))
        image = Image(labels, own if voxel is None else voxel, materials)
        return replace(image, voxel=tuple(coarsen * edge for edge in image.voxel)) if coarsen > 1 else image
    except ValueError as error:
        told = str(error)
        raise ValueError(told if told.startswith(str(path)) else f"{path}: {told}") from None


READERS = {
    ".npy": raw.read_npy,
    ".tif": tiff.read,
    ".tiff": tiff.read,
    ".mhd": raw.read_meta,
    ".mha": raw.read_meta,
    ".nrrd": nrrd.read,
    ".nhdr": nrrd.read,
    CHUNKED: zarr.read,
}
