"""Scenes with known answers, as files that need no Python: README.md beside this module says what they hold.

`names()` lists them, `load(name)` gives a scene and what is known of it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmark.parts import scene_of
from demheat.scene import Scene

__all__ = ["FOLDER", "Known", "load", "names", "read"]

FOLDER = Path(__file__).parent / "scenes"


class Known(NamedTuple):
    """What is known of a scene.

    Attributes
    ----------
    by : str
        "closed form", "series", "multipoles", "certain bounds" or "published".
    conductivity : float or None, W/(m K)
        Effective, along the load; None where no single number is asked for.
    error : float or None, W/(m K)
        The true one is no farther away.
    error_is : str
        What that rests on: "certain", "rounding" or "estimate".
    positions : (n, 3) float array, m
    times : (n,) float array, s, or None
        None in a steady state.
    temperature : (n,) float array, K or degrees Celsius
        There; of a periodic cell less that of the first point.
    flux : (n, 3) float array, W/m2, or None
    temperature_error, flux_error : float or None, K and W/m2
        As `error`; None without fluxes.
    """

    by: str
    conductivity: float | None
    error: float | None
    error_is: str
    positions: np.ndarray
    times: np.ndarray | None
    temperature: np.ndarray
    flux: np.ndarray | None
    temperature_error: float | None
    flux_error: float | None


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


def known_of(table: dict) -> Known:
    """What the file of a scene says is known of it."""
    known = table["known"]
    number = known.get("conductivity", {"value": None, "error": None, "error_is": ""})
    fields = known.get("fields", {"points": (), "temperature_error": None})
    points = fields["points"]
    timed, flowing = points and "time" in points[0], points and "flux" in points[0]
    return Known(
        by=known["by"],
        conductivity=number["value"],
        error=number["error"],
        error_is=number["error_is"],
        positions=np.array([each["position"] for each in points]).reshape(-1, 3),
        times=np.array([each["time"] for each in points]) if timed else None,
        temperature=np.array([each["temperature"] for each in points]),
        flux=np.array([each["flux"] for each in points]) if flowing else None,
        temperature_error=fields["temperature_error"],
        flux_error=fields.get("flux_error"),
    )
