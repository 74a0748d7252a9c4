"""A folder with the networks of slabs, an array a file, and with the matrix of all of them, mapped into memory."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.network.base import Network
from demheat.runtime.paths import replaced
from demheat.scene import Scene
from demheat.tiles.cells import Cells
from demheat.tiles.slabs import Slabs

# Of a Network: what has an entry for each particle, link or wall facet of a slab.
ARRAYS = (
    *("centers", "radii", "volumes", "phase", "indptr", "indices", "image", "conductance", "area"),
    *("wall_particle", "wall_side", "wall_conductance", "wall_area", "wall_distance", "wall_normal"),
)
MATRIX = "matrix"


class Store:
    """Arrays by name in a folder."""

    def __init__(self, folder):
        self.folder = checked_folder(folder)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ValueError(f"folder = {str(folder)!r}: cannot be made: {error.strerror}; must be another") from None

    def write(self, number: int, cells: Cells) -> None:
        """Keep what a slab sees."""
        here = self._of(number)
        here.mkdir()
        for name in ARRAYS:
            self.put(number, name, getattr(cells.network, name))

    def read(self, number: int, size, periodic) -> Network:
        """The network that a slab sees."""
        arrays = {name: np.load(self._of(number) / f"{name}.npy") for name in ARRAYS}
        return Network(size=size, periodic=periodic, **arrays)

    def put(self, number: int, name: str, values: np.ndarray) -> None:
        """Write one array of a slab, whole or not at all."""
        with replaced(self._of(number) / f"{name}.npy") as part:
            np.save(part, values)

    def get(self, number: int, name: str) -> np.ndarray:
        """One array of a slab, mapped."""
        return np.load(self._of(number) / f"{name}.npy", mmap_mode="r")

    def mapped(self, name: str, shape, kind) -> np.ndarray:
        """A new array of the matrix, on disk: what is written to it need not stay in memory."""
        here = self.folder / MATRIX
        here.mkdir(exist_ok=True)
        # A plain array of the same bytes: what is compiled for plain ones serves.
        return np.asarray(np.lib.format.open_memmap(here / f"{name}.npy", mode="w+", dtype=kind, shape=shape))

    def drop_matrix(self) -> None:
        """Take the files of the matrix away; who still maps them keeps them."""
        shutil.rmtree(self.folder / MATRIX, ignore_errors=True)

    def _of(self, number):
        return self.folder / f"slab-{number:04d}"


def checked_folder(folder) -> Path:
    """A path where a folder may be made, or ValueError."""
    try:
        path = Path(folder)
        free = "\0" not in str(path) and (not path.exists() or (path.is_dir() and not any(path.iterdir())))
    except (TypeError, OSError):
        raise ValueError(f"folder = {folder!r}: must be the name of a folder, new or empty") from None
    if not free:
        raise ValueError(f"folder = {str(folder)!r}: must be the name of a folder, new or empty")
    return path


class Parts(NamedTuple):
    """The slabs of a body, on disk."""

    scene: Scene
    store: Store
    cuts: list[Slabs]  # Each slab's view of all of them
    own: list[int]  # How many particles each slab owns

    @property
    def first(self) -> np.ndarray:
        """Number of each slab's first particle, and of all particles, (slabs + 1,) int array."""
        return np.concatenate([[0], np.cumsum(self.own)])

    def cells(self, number: int) -> Cells:
        """What a slab sees, read from disk."""
        slabs = self.cuts[number]
        periodic = np.full(3, slabs.periodic)
        periodic[slabs.axis] = False
        return Cells(self.store.read(number, np.array(self.scene.size), periodic), self.own[number], {})
