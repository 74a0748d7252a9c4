"""What a part of a script costs, told from inside: its imports and what it read lie before it."""

import resource
import time
from pathlib import Path


class Spent:
    """A clock that starts when it is made."""

    def __init__(self):
        try:
            # Peaks are counted from here on, as the studies count ours.
            Path("/proc/self/clear_refs").write_text("5")
        except OSError:
            pass
        self.base = _mib("VmRSS")
        self.wall, self.cpu = time.perf_counter(), _cpu()

    def so_far(self):
        """Seconds and the growth of resident memory at its peak: `wall_s`, `cpu_s`, `peak_mib`."""
        wall, cpu = time.perf_counter() - self.wall, _cpu() - self.cpu
        return {"wall_s": wall, "cpu_s": cpu, "peak_mib": max(_mib("VmHWM") - self.base, 0.0)}


def _cpu():
    parts = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(part.ru_utime + part.ru_stime for part in parts)


def _mib(name):
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(int(line.split()[1]) / 1024 for line in lines if line.startswith(name + ":"))
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
