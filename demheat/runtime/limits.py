"""Requests beyond this machine, refused before any heavy work: too much memory or time, and what would fit.

Estimates are of the least that is needed, so that nothing is refused that would fit; what they let pass may still be
too much.
"""

import math
import os
from collections.abc import Iterator
from pathlib import Path

# Less is never refused, and not looked up, which takes some 100 microseconds.
SMALL = 2**28
GIB = 2**30
# Bytes of a file's contents that are never refused.
ALWAYS = 2**26
# Seconds that computations last at most: a day.
LONGEST = 86_400.0
# Of a group of processes: its limit, and what it uses, pages of files included, which are given back. Version 2, 1.
GROUPS = (
    ("", "memory.max", "memory.current", ("active_file", "inactive_file")),
    ("memory", "memory.limit_in_bytes", "memory.usage_in_bytes", ("total_active_file", "total_inactive_file")),
)


def check_memory(name: str, value, needed: float, *, power: float = 1.0, remedy: str = "") -> None:
    """Refuse what would need more memory than is free."""
    if needed <= SMALL or needed <= (free := free_memory()):
        return
    # By logarithms, which integers of any length have.
    share = (math.log(max(free, 1.0)) - math.log(needed)) / power
    if hasattr(value, "__len__"):
        fits = f"about {math.exp(share):.1g} of that along each"
    else:
        fits = f"at most about {math.exp(math.log(value) + share):.3g}"
    gib = min(needed, 10**300) / GIB
    raise ValueError(
        f"{name} = {_short(value)}: takes {gib:.3g} GiB of memory or more, and {free / GIB:.3g} GiB are free; must be "
        f"{fits} here{remedy}"
    )


def check_steps(name: str, value, steps: float, seconds: float, *, remedy: str) -> None:
    """Refuse so many steps that they would last more than a day."""
    if not steps * seconds <= LONGEST:
        raise ValueError(
            f"{name} = {_short(value)}: takes {steps:.2g} steps of {seconds:.1g} s or more each, more than a day; at "
            f"most {LONGEST / seconds:.2g} are possible: must be {remedy}"
        )


def _short(value):
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:12]}... ({len(text)} characters)"


def check_free(path, needed) -> None:
    """Raise ValueError if what is read takes more memory than is free."""
    if needed > ALWAYS and needed > (free := free_memory()):
        raise ValueError(
            f"{path}: takes {needed / GIB:.3g} GiB of memory or more, and {free / GIB:.3g} GiB are free; must be a "
            "smaller file here"
        )


def free_memory(root: Path = Path("/")) -> float:
    """Bytes that this process may still use: of the machine, and of the groups that limit it (Linux: cgroups)."""
    return min([_of_machine(root), *_of_groups(root)])


def _of_machine(root):
    try:
        for line in (root / "proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    except (OSError, ValueError, IndexError):
        pass
    try:  # No Linux: what is built in, used or not.
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return math.inf


def _of_groups(root) -> Iterator[float]:
    """What is free in the group of this process and in those that hold it."""
    try:
        lines = (root / "proc/self/cgroup").read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, kinds, path = (line.split(":", 2) + ["", ""])[:3]
        for folder, *files in GROUPS:
            if folder in kinds.split(","):
                base = root / "sys/fs/cgroup" / folder
                group = Path(path.lstrip("/"))
                # In a container the path may be that of the host: groups that are not seen are passed over.
                for each in (group, *group.parents) if path != "/" else (Path(),):
                    yield _of_group(base / each, *files)


def _of_group(folder, limit, used, given_back):
    """Limit less use of one group; infinite without a limit."""
    try:
        most = float((folder / limit).read_text())  # "max" without one
        now = float((folder / used).read_text())
        stat = dict(line.split() for line in (folder / "memory.stat").read_text().splitlines())
    except (OSError, ValueError):
        return math.inf
    return max(0.0, most - now + sum(float(stat.get(name, 0)) for name in given_back))
