"""What a part of a script costs; imported by scripts beside it, by whatever Python has their libraries."""

import resource
import time


def start():
    """Now; the peak of memory begins here."""
    with open("/proc/self/clear_refs", "w") as file:
        # Linux then sets VmHWM to what is resident.
        file.write("5")
    return time.perf_counter(), _cpu(), _memory("VmRSS")


def since(before):
    """Cost since `start`: wall and processor seconds, and growth of resident memory at its peak, MiB."""
    wall, cpu, base = before
    return {
        "wall_s": time.perf_counter() - wall,
        "cpu_s": _cpu() - cpu,
        "peak_mib": _memory("VmHWM") - base,
    }


def _cpu():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _memory(name):
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith(f"{name}:"))
