"""Long compiled loops in blocks of a fraction of a second: between them Ctrl-C is heard and budgets are looked at."""

import time

from demheat.runtime.deadline import look

# Seconds that a block should last.
SECONDS = 0.1


def blocks(number, first):
    """Cut a range into blocks that last about as long as they should, the next at most twice as long as the last.

    For loops whose entries do not depend on each other: where the cuts are differs from run to run.
    """
    begin, length = 0, first
    while begin < number:
        look("loops")
        end, started = min(number, begin + length), time.perf_counter()
        yield begin, end
        spent, begin = time.perf_counter() - started, end
        length = max(first, int(length * min(2.0, SECONDS / max(spent, 1e-9))))
