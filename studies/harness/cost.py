"""What a solve costs: wall and processor seconds, peak memory; and what the machine's memory can deliver."""

import ctypes
import gc
import os
import resource
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from demheat.runtime.process_state import stopwatch

MIB = 2**20


def measured(function, /, *args, **knobs):
    """Call a function and say what the call cost."""
    gc.collect()
    _give_back_freed_memory()
    peak_by = "VmHWM" if _reset_peak() else "ru_maxrss"
    base = _resident_mib()
    spent = stopwatch()
    value = function(*args, **knobs)
    cost = spent()
    peak = _status_mib("VmHWM") if peak_by == "VmHWM" else _max_rss_mib()
    return value, {**cost, "peak_mib": max(peak - base, 0.0), "base_mib": base, "peak_by": peak_by}


def triad_gbs(*, threads=None, elements=8_000_000, repeats=5):
    """Memory bandwidth of a = b + s c, best of a few, GB/s, counted as STREAM counts it (24 bytes per element)."""
    import numpy as np

    threads = threads or len(os.sched_getaffinity(0))
    a, b, c = (np.full(elements, value) for value in (0.0, 1.0, 2.0))
    # A block's product stays in the second-level cache, so that only b, c and a cross the memory bus.
    block = 16_384

    def sweep(part):
        product = np.empty(block)
        for start in range(part * elements // threads, (part + 1) * elements // threads, block):
            stop = min(start + block, (part + 1) * elements // threads)
            np.multiply(c[start:stop], 3.0, out=product[: stop - start])
            np.add(b[start:stop], product[: stop - start], out=a[start:stop])

    best = float("inf")
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(repeats):
            start = time.perf_counter()
            list(pool.map(sweep, range(threads)))
            best = min(best, time.perf_counter() - start)
    return 24e-9 * elements / best


def _reset_peak():
    """Set VmHWM back to the present resident size (Linux); True if the kernel did so."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return False
    return True


def _give_back_freed_memory():
    """Return freed heap to the system: what a warm-up freed would otherwise hide as much of the call's own use."""
    try:
        ctypes.CDLL(None).malloc_trim(0)
    except (OSError, AttributeError):
        pass


def _status_mib(name):
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(name + ":"):
            return int(line.split()[1]) * 1024 / MIB
    raise OSError(f"/proc/self/status has no {name}")


def _resident_mib():
    try:
        return _status_mib("VmRSS")
    except OSError:
        return 0.0


def _max_rss_mib():
    # Kilobytes on Linux, bytes on macOS.
    unit = 1 if os.uname().sysname == "Darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / MIB
