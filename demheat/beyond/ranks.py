"""Ranks of an MPI run: who they are, whether a solve fits where they run, and what each of its stages costs them."""

import ctypes
import gc
import os
import resource
import sys
import time
from contextlib import contextmanager, suppress
from importlib import import_module

from demheat.runtime.limits import check_memory, free_memory

NEEDED = (
    "demheat.mpi needs {needed}, which this Python does not find ({reason}): see the page mpi of the manual for their "
    "commands; without them {instead} does the same on one machine"
)


def imported(*names: str, instead: str):
    """Modules by their names, MPI before what is built on it."""
    names = ("mpi4py.MPI", *names)
    try:
        return [import_module(name) for name in names]
    except (ImportError, RuntimeError) as error:  # mpi4py says so of a missing MPI
        needed, reason = " and ".join(name.partition(".")[0] for name in names), " ".join(str(error).split())
        raise ImportError(NEEDED.format(needed=needed, reason=reason, instead=instead)) from None


def here(comm) -> int:
    """How many ranks share this machine."""
    return comm.Split_type(sys.modules["mpi4py.MPI"].COMM_TYPE_SHARED).size


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def outlook(needed: float, comm) -> str:
    """What a solve will take on this machine, in words."""
    share = here(comm)
    gib = needed * share / comm.size / 2**30
    return f"about {gib:.2g} GiB on this machine for {share} of {comm.size} ranks, {free_memory() / 2**30:.3g} are free"


def check_fits(name: str, value, needed: float, comm, *, power: float = 1.0) -> None:
    """Refuse on all ranks what does not fit where one of them is."""
    refused = None
    try:
        check_memory(name, value, needed * here(comm) / comm.size, power=power)
    except ValueError as error:
        refused = str(error)
    refused = next(filter(None, comm.allgather(refused)), None)
    if refused:
        raise ValueError(refused)


class Costs:
    """Seconds of each stage and bytes at the peak, of all ranks."""

    def __init__(self, comm):
        self.comm, self.stages = comm, {}
        self.before = comm.allreduce(_peak())

    @contextmanager
    def of(self, name):
        """Count what is done until the end of `with` as a stage, and give back what it has freed."""
        wall, cpu = time.perf_counter(), time.process_time()
        yield
        give_back()
        took = self.comm.allreduce(time.process_time() - cpu)
        slowest = max(self.comm.allgather(time.perf_counter() - wall))
        self.stages |= {f"{name}_s": slowest, f"{name}_cpu_s": took, f"{name}_bytes": self.comm.allreduce(_peak())}

    def stats(self) -> dict:
        """Bytes at the peak, and those of Python and libraries alone; <stage>_s, <stage>_cpu_s and <stage>_bytes.

        The latter are seconds of the slowest rank, CPU-seconds of all ranks, and bytes at the peak so far.
        """
        return self.stages | {"bytes": self.comm.allreduce(_peak()), "bytes_before": self.before}


def give_back() -> None:
    """Return freed memory to the system: what one stage has freed would else stand beside what the next one takes."""
    gc.collect()
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)


def _peak():
    """Bytes that this process has held at most."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
