"""How much of a row's time was not its own: processors that others used, and kernels that it had to compile."""

import math
import os
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from demheat.runtime.process_state import cpu_seconds
from studies.harness.cost import triad_gbs

STAT = Path("/proc/stat")
# Of these processors' time: with more in other hands a row is noisy.
NOISY = 0.1
# Shorter than this, s, the kernel's ticks of 10 ms say too little.
SHORTEST = 0.2
# Between two looks at a machine that is not quiet, s.
PAUSE = 2.0
# Looks after a row at most, until one is quiet.
LOOKS = 3
# For so long, s, a look is good for rows that have themselves been quiet: it takes as long as many of them.
LASTS = 10.0
# Each processor's count may be wrong by so much, s.
TICK = 1 / os.sysconf("SC_CLK_TCK")


@contextmanager
def compiling():
    """Seconds that this process compiles kernels in the meantime, as a list that is filled at the end.

    A warm-up is small, and the first row on a machine that meets a kernel of large bodies alone compiles it within its
    time. What Numba takes from its cache does not count.
    """
    spent = []
    if "numba" not in sys.modules:
        yield spent
        return
    from numba.core.event import install_timer

    with install_timer("numba:compile", spent.append):
        yield spent


class Moment(NamedTuple):
    """A time, s, seconds that the processors we may use were busy until then, and those of this process."""

    time: float
    busy: float
    own: float


def moment():
    """Now; busy is not-a-number where the system does not tell (it does on Linux)."""
    return Moment(time.monotonic(), _busy(), cpu_seconds())


def others(begin, end=None):
    """Share of our processors' time between two moments that went to others, 0 to 1.

    What a hypervisor gave to other machines counts; what this process and its finished children used does not, nor
    what may be the coarseness of the count.
    """
    end = moment() if end is None else end
    elapsed = end.time - begin.time
    if elapsed < SHORTEST:
        return math.nan
    used = (end.busy - begin.busy) - (end.own - begin.own) - TICK * processors()
    return min(max(used / (elapsed * processors()), 0.0), 1.0) if math.isfinite(used) else math.nan


def loudest(*shares):
    """The largest of some shares, rounded; not-a-number if none is known."""
    return round(max((share for share in shares if math.isfinite(share)), default=math.nan), 3)


def processors():
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


def look():
    """Bandwidth of the memory, GB/s, and the share of others meanwhile."""
    begin = moment()
    bandwidth = round(triad_gbs(repeats=2), 1)
    time.sleep(max(0.0, SHORTEST - (time.monotonic() - begin.time)))
    return bandwidth, others(begin)


def waiting(seconds, say, *, clock=time.monotonic, sleep=time.sleep):
    """What waits for a quiet machine, at most so long in all its calls together."""
    left = float(seconds)

    def wait(seen):
        nonlocal left
        if seen[1] > NOISY and left > 0:
            say(
                f"others use {seen[1]:.0%} of the processors, and costs measured meanwhile do not count: waiting for "
                f"at most {left:.0f} s (--wait 0: not at all)"
            )
            begin = clock()
            while seen[1] > NOISY and clock() - begin < left:
                sleep(PAUSE)
                seen = look()
            left -= clock() - begin
            if left <= 0:
                say("no more waiting in this run; rows that others disturb say so")
        return seen

    return wait


def quietly(compute, *, seconds=0.0, say=print, clock=time.monotonic):
    """Rows one after another, each when the machine is quiet, with what was seen of it before and after."""
    wait, last, looked = waiting(seconds, say), None, -math.inf

    def computed(name, study, case):
        nonlocal last, looked
        if last is None:
            last, looked = look(), clock()
        # What is seen after a row is what is seen before the next.
        before = last = wait(last)
        row = compute(name, study, case)
        own = row.get("noise", math.nan)
        if not own <= NOISY or clock() - looked > LASTS:
            last, looked = _after(), clock()
        noise = loudest(own, before[1], last[1])
        return row | {"triad_gbs": before[0]} | ({"noise": noise} if math.isfinite(noise) else {})

    return computed


def _after():
    """A look after a row; somebody's blink in it is no noise of the row, what is still there in the next look is."""
    for _ in range(LOOKS):
        seen = look()
        if not seen[1] > NOISY:
            break
    return seen


def _busy():
    """Seconds that the processors which this process may use were not idle, whoever used them."""
    ours = {f"cpu{number}" for number in os.sched_getaffinity(0)}
    try:
        lines = [line.split() for line in STAT.read_text().splitlines() if line.startswith("cpu")]
    except OSError:
        return math.nan
    ticks = [list(map(int, words[1:9])) for words in lines if words[0] in ours]
    if len(ticks) < len(ours):
        return math.nan
    # user, nice, system, idle, iowait, irq, softirq, steal; time of guests is in user.
    return sum(sum(each) - each[3] - each[4] for each in ticks) / os.sysconf("SC_CLK_TCK")


# When this process began to work.
START = moment()
