"""Tasks on a Dask cluster: sent all at once, home one by one, sent again when their worker dies.

Queue, scheduler, workers and dashboard are Dask's; here is only what a row needs of them.
"""

import asyncio
import os
import uuid
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

# Dask gives a task up after a few workers have died under it. It is sent again so often: what itself kills a worker
# would go round for ever.
SENT_AGAIN = 5
# For workers to end when all is done, s: on a busy machine they take some.
PATIENCE = 60
MISSING = "a cluster needs Dask: pip install 'demheat[distributed]'"


@contextmanager
def cluster(scheduler: str | None = None, workers: int | None = None):
    """Client of a running scheduler, or of workers of one thread each that are started here and end here."""
    try:
        import distributed
    except ImportError:
        raise ValueError(MISSING) from None
    if scheduler is None:
        # Rows have memory of their own, outside the worker's: its limits would only count wrongly.
        knobs = {"n_workers": workers, "threads_per_worker": 1, "memory_limit": 0}
        with distributed.LocalCluster(dashboard_address="127.0.0.1:0", **knobs) as local:
            with distributed.Client(local) as client:
                yield client
                local.sync(_ended, local)
        return
    try:
        client = distributed.Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise ValueError(f"scheduler = {scheduler!r}: must be the address of a Dask scheduler: {error}") from None
    with client:
        yield client


async def _ended(local):
    """End the workers of a cluster after their work. Dask itself kills those that take over four seconds, and warns."""
    await asyncio.gather(*(nanny.close(timeout=PATIENCE) for nanny in local.workers.values()))


def completed(client, function: Callable, tasks: Sequence[tuple], *, label: str) -> Iterator[tuple[int, object]]:
    """Call a function on a cluster with each of many arguments; results come home in the order in which they end.

    Workers may die or join meanwhile.
    """
    from distributed import KilledWorker, as_completed

    def sent(number):
        future = client.submit(function, *tasks[number], key=f"{label}-{uuid.uuid4().hex}")
        numbers[future] = number
        return future

    numbers, deaths = {}, Counter()
    home = as_completed([sent(number) for number in range(len(tasks))])
    for future in home:
        number = numbers.pop(future)
        if future.status in ("cancelled", "lost"):
            raise OSError("the scheduler is gone, or has cancelled the rows; those done are kept, begin again")
        result = future.exception() if future.status == "error" else future.result()
        if isinstance(result, KilledWorker):
            deaths[number] += 1
            if deaths[number] <= SENT_AGAIN:
                home.add(sent(number))
                continue
        yield number, result


def row_environment() -> dict[str, str]:
    """The environment without what Dask sets for its workers: a row must cost there what it costs elsewhere."""
    import dask
    import distributed  # noqa: F401 - its defaults

    own = dask.config.get("distributed.nanny.pre-spawn-environ", {})
    return {name: value for name, value in os.environ.items() if str(own.get(name)) != value}
