"""Planned in-place transforms, the one home of pyfftw: real Fourier in a periodic cell, sine and cosine in a box.

Plans of large grids are measured, and their wisdom is kept in the folder of the environment variable DEMHEAT_CACHE,
else in the user's cache folder, so each size is measured once.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

# FFTW's threads wait in a busy loop unless told otherwise, which is 4 times slower when other work shares the cores.
# Its OpenMP runtime reads this once, when the library is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

import pyfftw  # noqa: E402

# Estimated over measured plans, in place, 2 threads, CPU time: no difference at 128^3, 1.3 to 1.5 at 256^3, where
# measuring takes about 20 s, once.
MEASURED_FROM = 4_000_000
PLANNING_SECONDS = 20.0
_loaded = set()


class Transform(NamedTuple):
    """A field of one or three components and the plans that transform it in place.

    Attributes
    ----------
    real : (components, nx, ny, nz or more) float array
        Values; in a periodic cell the last axis is padded and the padding means nothing.
    modes : (components, mx, my, mz) complex or float array
        Coefficients, in the same memory.
    forward, backward : callable ()
        Fill `modes` from `real`, and back; neither is normalised.
    scale : float
        1 / scale is what a round trip multiplies values by.
    """

    real: np.ndarray
    modes: np.ndarray
    forward: object
    backward: object
    scale: float


def fourier(components, shape, dtype, threads) -> Transform:
    """Real discrete Fourier transform of a periodic field.

    Parameters
    ----------
    components : int
    shape : (3,) tuple of int
        Values along each axis.
    dtype : numpy float type
    threads : int
    """
    half = shape[2] // 2 + 1
    modes = pyfftw.zeros_aligned((components, shape[0], shape[1], half), np.result_type(dtype, np.complex64))
    padded = modes.view(dtype)
    forward, backward = [], []
    for values, coefficients in zip(padded[..., : shape[2]], modes, strict=True):
        plan = {"axes": (0, 1, 2), "threads": threads}
        forward.append(_planned(values, coefficients, direction="FFTW_FORWARD", **plan))
        backward.append(_planned(coefficients, values, direction="FFTW_BACKWARD", **plan))
    return Transform(padded, modes, _all(forward), _all(backward), 1.0 / np.prod(shape, dtype=float))


def trigonometric(kinds, shape, dtype, threads) -> Transform:
    """Sine and cosine transforms of fields in a box.

    Parameters
    ----------
    kinds : sequence of 3-tuples of str
        Per component and axis: "sin" or "cos", each of type 1 (values on the walls, those that are zero left out) or
        2 (values half a step inside), as "sin1", "cos1", "sin2", "cos2".
    shape : (3,) tuple of int
    dtype : numpy float type
    threads : int
    """
    values = pyfftw.zeros_aligned((len(kinds), *shape), dtype)
    forward, backward = [], []
    for component, names in zip(values, kinds, strict=True):
        plan = {"axes": (0, 1, 2), "threads": threads}
        there = tuple(_REAL_TRANSFORMS[name][0] for name in names)
        back = tuple(_REAL_TRANSFORMS[name][1] for name in names)
        forward.append(_planned(component, component, direction=there, **plan))
        backward.append(_planned(component, component, direction=back, **plan))
    scale = 1.0
    for name, n in zip(kinds[0], shape, strict=True):
        scale /= 2.0 * (n + {"sin1": 1, "cos1": -1}.get(name, 0))
    return Transform(values, values, _all(forward), _all(backward), scale)


# Forward and backward transform of FFTW.
_REAL_TRANSFORMS = {
    "sin1": ("FFTW_RODFT00", "FFTW_RODFT00"),
    "cos1": ("FFTW_REDFT00", "FFTW_REDFT00"),
    "sin2": ("FFTW_RODFT10", "FFTW_RODFT01"),
    "cos2": ("FFTW_REDFT10", "FFTW_REDFT01"),
}


def _all(plans):
    def execute():
        for plan in plans:
            plan.execute()

    return execute


def _planned(source, target, **plan):
    """Plan once: from kept wisdom if there is any, else measured where that pays."""
    _load_wisdom(source.dtype)
    known = ("FFTW_MEASURE", "FFTW_DESTROY_INPUT")
    try:
        return pyfftw.FFTW(source, target, flags=(*known, "FFTW_WISDOM_ONLY"), **plan)
    except RuntimeError:  # No wisdom for this transform yet.
        pass
    if source.size < MEASURED_FROM:
        return pyfftw.FFTW(source, target, flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT"), **plan)
    planned = pyfftw.FFTW(source, target, flags=known, planning_timelimit=PLANNING_SECONDS, **plan)
    _save_wisdom(source.dtype)
    return planned


def _precision(dtype):
    """Which of pyfftw's three sets of wisdom (double, single, long double), and its file."""
    single = np.dtype(dtype) in (np.float32, np.complex64)
    folder = os.environ.get("DEMHEAT_CACHE")
    if not folder:
        folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "demheat"
    return (1 if single else 0), Path(folder) / f"fftw-wisdom-{'float32' if single else 'float64'}.txt"


def _load_wisdom(dtype):
    """Hand FFTW the kept wisdom, once per process and file; FFTW itself refuses that of another version."""
    which, path = _precision(dtype)
    if path in _loaded:
        return
    _loaded.add(path)
    try:
        kept = path.read_bytes()
    except OSError:
        return
    wisdom = [b"", b"", b""]
    wisdom[which] = kept
    pyfftw.import_wisdom(tuple(wisdom))


def _save_wisdom(dtype):
    """Keep the wisdom; a cache folder that cannot be written costs only the next process its time."""
    which, path = _precision(dtype)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Written aside and moved: a process that reads meanwhile sees the old file or the new one.
        handle, aside = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(pyfftw.export_wisdom()[which])
        os.replace(aside, path)
    except OSError:
        pass
