"""Planned in-place transforms, the one home of pyfftw: real Fourier in a periodic cell, sine and cosine in a box.

Plans of large grids are measured, and their wisdom is kept in the folder of the environment variable DEMHEAT_CACHE,
else in the user's cache folder, so each size is measured once.
"""

import os
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyfftw

from demheat.runtime.process_state import open_after_fork
from references.fft.sweeps import Plans, Transform, Worker

# CPU time of estimated over measured plans of planes and of columns: 1.5 and 1.4 at 128^3, 1.1 and 1.7 at 512^3.
# Measuring takes 0.2 s to 1 s, once, for only one block of planes and one buffer of columns is planned.
MEASURED_FROM = 1_000_000
PLANNING_SECONDS = 5.0
_loaded, _PLANNING = set(), open_after_fork(threading.RLock())


def fourier(components: int, shape: tuple, dtype: type, threads: int) -> Transform:
    """Real discrete Fourier transform of a periodic field."""
    half = shape[2] // 2 + 1
    modes = pyfftw.zeros_aligned((components, shape[0], shape[1], half), np.result_type(dtype, np.complex64))
    ways = [_Ways("FFTW_FORWARD", "FFTW_FORWARD", "FFTW_BACKWARD", "FFTW_BACKWARD")] * components
    return _transform(modes.view(dtype), modes, shape, ways, 1.0 / np.prod(shape, dtype=float), threads)


def trigonometric(kinds: Sequence, shape: tuple, dtype: type, threads: int) -> Transform:
    """Sine and cosine transforms of fields in a box."""
    values = pyfftw.zeros_aligned((len(kinds), *shape), dtype)
    ways = []
    for names in kinds:
        there, back = (tuple(_REAL_TRANSFORMS[name][way] for name in names) for way in (0, 1))
        ways.append(_Ways(there[:1], there[1:], back[:1], back[1:]))
    scale = 1.0
    for name, n in zip(kinds[0], shape, strict=True):
        scale /= 2.0 * (n + {"sin1": 1, "cos1": -1}.get(name, 0))
    return _transform(values, values, shape, ways, scale, threads)


# Forward and backward transform of FFTW.
_REAL_TRANSFORMS = {
    "sin1": ("FFTW_RODFT00", "FFTW_RODFT00"),
    "cos1": ("FFTW_REDFT00", "FFTW_REDFT00"),
    "sin2": ("FFTW_RODFT10", "FFTW_RODFT01"),
    "cos2": ("FFTW_REDFT10", "FFTW_REDFT01"),
}


class _Ways(NamedTuple):
    """FFTW's names of a component's transforms: there and back, along x and along y and z."""

    there_x: str | tuple
    there: str | tuple
    back_x: str | tuple
    back: str | tuple


def _transform(real, modes, shape, ways, scale, threads):
    measured = real.size >= MEASURED_FROM

    def worker(blocks, count):
        # Blocks lie one after another, the last one beyond some of the largest: FFTW may count on alignment only if all
        # of them have it.
        largest = _misaligned(modes[0, : max(blocks)])
        loose = {n: largest or _misaligned(modes[0, :n]) for n in blocks}
        planes = {n: _plane_plans(real[:, :n, :, : shape[2]], modes[:, :n], ways, measured, loose[n]) for n in blocks}
        buffer = pyfftw.zeros_aligned((len(modes), count, modes.shape[1]), modes.dtype)
        return Worker(planes, buffer, _column_plans(buffer, ways, measured))

    return Transform(real, modes, scale, shape[2], threads, worker)


def _misaligned(block):
    return block.nbytes % pyfftw.simd_alignment > 0


def _plane_plans(values, modes, ways, measured, loose):
    """Plans made on the first block of planes, for any block."""
    knobs = {"axes": (1, 2), "loose": loose, "measured": measured}
    parts = list(zip(values, modes, ways, strict=True))
    forward = [_planned(v, m, direction=way.there, **knobs) for v, m, way in parts]
    backward = [_planned(m, v, direction=way.back, **knobs) for v, m, way in parts]
    return Plans([_moved(plan) for plan in forward], [_moved(plan) for plan in backward])


def _column_plans(buffer, ways, measured):
    knobs = {"axes": (1,), "loose": False, "measured": measured}
    forward = [_planned(rows, rows, direction=way.there_x, **knobs) for rows, way in zip(buffer, ways, strict=True)]
    backward = [_planned(rows, rows, direction=way.back_x, **knobs) for rows, way in zip(buffer, ways, strict=True)]
    return Plans([plan.execute for plan in forward], [plan.execute for plan in backward])


def _moved(plan):
    """The plan's transform of other arrays, alike in all but their place."""

    def execute(source, target):
        plan.update_arrays(source, target)
        plan.execute()

    return execute


def _planned(source, target, *, loose, measured, **plan):
    """Plan once: from kept wisdom if there is any, else measured where that pays; in place, for one thread."""
    # FFTW's wisdom and time limit are the process's: a thread that plans meanwhile would plan otherwise.
    with _PLANNING:
        return _plan(source, target, loose=loose, measured=measured, **plan)


def _plan(source, target, *, loose, measured, **plan):
    _load_wisdom(source.dtype)
    flags = ("FFTW_DESTROY_INPUT", *(["FFTW_UNALIGNED"] if loose else []))
    try:
        return pyfftw.FFTW(source, target, flags=("FFTW_MEASURE", "FFTW_WISDOM_ONLY", *flags), **plan)
    except RuntimeError:  # No wisdom for this transform yet.
        pass
    if not measured:
        return pyfftw.FFTW(source, target, flags=("FFTW_ESTIMATE", *flags), **plan)
    planned = pyfftw.FFTW(source, target, flags=("FFTW_MEASURE", *flags), planning_timelimit=PLANNING_SECONDS, **plan)
    _save_wisdom(source.dtype)
    return planned


def _precision(dtype):
    """Which of pyfftw's three sets of wisdom (double, single, long double), and its file."""
    single = np.dtype(dtype) in (np.float32, np.complex64)
    folder = os.environ.get("DEMHEAT_CACHE")
    if not folder:
        folder = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "demheat"
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
    except OSError:
        return
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(pyfftw.export_wisdom()[which])
        os.replace(aside, path)
    except OSError:
        Path(aside).unlink(missing_ok=True)
