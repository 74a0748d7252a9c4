"""Scenes with known answers, as files that need no Python: README.md beside this module says what they hold.

`names()` lists them, `load(name)` gives a scene and what is known of it.
"""

import json
from pathlib import Path

from demheat.io.known import Known, known_of, scene_of
from demheat.scene import Scene

__all__ = ["FOLDER", "Known", "load", "names", "read"]

FOLDER = Path(__file__).parent / "scenes"


def names(*, group: str | None = None) -> list[str]:
    """Names of all scenes, or of those of a group, by their files.

    Parameters
    ----------
    group : str, optional
        As it stands in the files: "cubic arrays", "transients", ...

    Examples
    --------
    >>> import benchmark
    >>> benchmark.names(group="NAFEMS")
    ['nafems-t2', 'nafems-t3', 'nafems-t4']
    """
    found = sorted(path.stem for path in FOLDER.glob("*.json"))
    return found if group is None else [name for name in found if read(name)["group"] == group]


def read(name: str) -> dict:
    """What the file of a scene holds."""
    if name not in names():
        raise ValueError(f"name = {name!r}: must be one of {', '.join(names())}")
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))


def load(name: str, *, image=None) -> tuple[Scene, Known]:
    """A scene, and what is known of it.

    Parameters
    ----------
    name : str
    image : path, optional
        Of the labels (.npy or .tiff) of a scene whose image is not shipped: its file says where that is to be had.

    Raises
    ------
    ValueError
        If there is no such scene, or the image is missing or another one.

    Examples
    --------
    >>> import benchmark
    >>> scene, known = benchmark.load("sc-third-s10")
    >>> print(f"{known.conductivity:.9f}, {known.error:.0e}, {known.by}")
    1.395734838, 2e-12, series
    """
    table = read(name)
    return scene_of(table, image=image), known_of(table)
