"""Only here: tasks on Dask workers lost with those that are killed; skipped without Dask."""

import atexit
import logging
import os
import random
import signal
import time

import pytest

from demheat.beyond import cluster

pytest.importorskip("distributed")


def pids_of(client):
    """Processes of the workers that answer; those that are dying do not."""
    found = client.run(os.getpid, on_error="return")
    return sorted(pid for pid in found.values() if isinstance(pid, int))


def test_workers_killed_three_times_lose_no_task():
    drawn, killed, home = random.Random(20), [], {}

    def work(number, seconds):
        if number == 5:
            raise RuntimeError("an error of the task's own")
        time.sleep(seconds)
        return os.getpid()

    with cluster.cluster(workers=2) as client:
        tasks = [(number, 0.3) for number in range(16)]
        for number, result in cluster.completed(client, work, tasks, label="work"):
            assert number not in home
            home[number] = result
            # After so many tasks, while others run, one of those that work is killed.
            if len(home) in (2, 6, 10):
                killed.append(drawn.choice(pids_of(client)))
                os.kill(killed[-1], signal.SIGKILL)
    assert sorted(home) == list(range(16)) and len(set(killed)) == 3
    assert str(home.pop(5)) == "an error of the task's own" and all(isinstance(pid, int) for pid in home.values())
    # New ones have taken the places of those that were killed.
    assert len({*home.values(), *killed}) >= 4


def test_workers_that_end_slowly_are_neither_killed_nor_complained_of():
    said = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: said.append(record.getMessage())
    logger = logging.getLogger("distributed.nanny")
    logger.addHandler(handler)
    try:
        with cluster.cluster(workers=2) as client:
            # Dask's own patience is four seconds.
            client.run(atexit.register, time.sleep, 5.0)
    finally:
        logger.removeHandler(handler)
    assert said == []
