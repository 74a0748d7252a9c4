"""Only here: sweeps on a Dask cluster whose rows are not those of this process, or that a crash ends."""

import os
import sys
import time

import pytest
from test_sweep import measured_apart

from demheat import sweep
from demheat.beyond import cluster
from demheat.runtime.machine import host

pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client():
    with cluster.cluster(workers=2) as found:
        yield found


def test_rows_are_those_of_this_process(client, tmp_path):
    factor = 0.1

    def scaled(x):
        # A closure, as notebooks are full of.
        if x == 3:
            raise RuntimeError("no convergence")
        return {"value": factor * x, "word": "a"}

    cases = {"x": [1.0, 2.0, 3.0]}
    here = sweep(scaled, cases)
    assert measured_apart(sweep(scaled, cases, client=client, out=tmp_path / "rows.csv")) == measured_apart(here)
    assert here[0]["host"] == host()
    # Resumed without a cluster, from its file.
    again = sweep(lambda x: 1 / 0, {"x": [1.0, 2.0]}, out=tmp_path / "rows.csv")
    assert measured_apart(again) == measured_apart(here[:2])


def test_a_crash_and_a_time_limit_are_errors_of_their_rows(client):
    def odd(what):
        if what == "dies":
            os.abort()
        if what == "sleeps":
            time.sleep(60)
        if what == "speaks":
            print("last words", file=sys.stderr)
            os._exit(3)
        return float(os.getpid())

    begun = time.monotonic()
    rows = sweep(odd, {"what": ["dies", "sleeps", "speaks", "a", "b"]}, client=client, timeout=12.0)
    assert time.monotonic() - begun < 55
    errors = {row["what"]: row["error"] for row in rows}
    assert "SIGABRT" in errors["dies"] and errors["sleeps"] == "TimeoutError: not finished after 12 s"
    assert errors["speaks"] == "process ended with status 3; last words" and errors["a"] == errors["b"] == ""
    # Each in a process of its own.
    assert len({rows[3]["value"], rows[4]["value"], *client.run(os.getpid).values()}) == 4


def test_the_environment_is_not_that_of_dasks_workers(client):
    """Dask tells its workers how to give memory back: a row would cost something else there."""

    def found(name):
        return os.environ.get(name, "unset")

    name = "MALLOC_TRIM_THRESHOLD_"
    (row,) = sweep(found, [{"name": name}], client=client)
    assert row["value"] == "unset" != client.submit(found, name).result()
