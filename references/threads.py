"""Plain Python threads for compiled loops that release the interpreter's lock: they sleep while they wait."""

import os
from concurrent.futures import ThreadPoolExecutor
from numbers import Integral

# Beyond it threads would only wait for each other on any machine.
MOST_THREADS = 1024


def thread_count(threads: int | None) -> int:
    """Number of threads, one per processor for None."""
    if threads is None:
        return os.cpu_count() or 1
    if not isinstance(threads, Integral) or isinstance(threads, bool) or not 1 <= threads <= MOST_THREADS:
        valid = f"a whole number >= 1, or None for one per processor; at most {MOST_THREADS}"
        raise ValueError(f"threads = {threads!r}: must be {valid}")
    return int(threads)


class Team:
    """A number of threads that share loops over the planes of a grid."""

    def __init__(self, threads):
        self.threads = threads
        self._pool = ThreadPoolExecutor(threads - 1) if threads > 1 else None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._pool:
            self._pool.shutdown()

    def run(self, kernel, planes, *arguments):
        """Call kernel(*arguments, low, high) on chunks that make up range(planes)."""
        parts = min(self.threads, planes)
        bounds = [planes * part // parts for part in range(parts + 1)]
        waiting = [
            self._pool.submit(kernel, *arguments, low, high) for low, high in zip(bounds[1:-1], bounds[2:], strict=True)
        ]
        kernel(*arguments, 0, bounds[1])
        for future in waiting:
            future.result()
