"""Rows of a study on a Dask cluster: each in a fresh process of some worker, home one by one."""

from contextlib import contextmanager
from functools import cache, partial

from demheat.beyond.cluster import cluster, completed, row_environment
from studies.harness import runner
from studies.harness.cost import triad_gbs
from studies.harness.provenance import provenance
from studies.harness.store import case_key

# What rows of all workers must agree in.
ORIGIN = ("commit", "versions")


@contextmanager
def spreading(scheduler, workers, say):
    """What spreads rows over a cluster for `runner.run_study`; None if none is asked for."""
    if scheduler is None and workers is None:
        yield None
        return
    with cluster(scheduler, workers) as client:
        say(f"dashboard {client.dashboard_link}")
        yield spread_over(client)


def spread_over(client):
    """What `runner.run_study` needs to have its rows made by the workers of a cluster."""

    def spread(name, study, cases):
        expected = _origin(provenance(study))
        _check_workers(client, name, expected)
        tasks = [(name, case_key(case)) for case in cases]
        for number, row in completed(client, row_of, tasks, label=name):
            if isinstance(row, Exception):
                row = runner.failed(study, cases[number], f"{type(row).__name__}: {row}")
            elif _origin(row) != expected:
                row = runner.failed(study, cases[number], f"made by {_told(row)}, not by {_told(expected)}")
            yield number, row

    return spread


def row_of(name, key):
    """Compute one row in a fresh process of this machine."""
    study = runner.load(name)
    bandwidth, start = _bandwidth(), partial(runner.started, environment=row_environment())
    row = runner.spawn_row(name, study, runner.find_case(study, key), start=start)
    return {**row, "triad_gbs": bandwidth}


def origin_of(name):
    """What a row of this machine would say of its code and libraries."""
    return _origin(provenance(runner.load(name)))


@cache
def _bandwidth():
    return round(triad_gbs(), 1)


def _origin(row):
    return {name: str(row[name]) for name in ORIGIN}


def _told(row):
    return ", ".join(f"{name} {row[name]}" for name in ORIGIN)


def _check_workers(client, name, expected):
    """Raise ValueError if a worker has other code or libraries than we: before an hour's solve."""
    for worker, origin in client.run(origin_of, name, on_error="return").items():
        if isinstance(origin, OSError):
            continue  # died meanwhile; what takes its place is known by its rows
        if isinstance(origin, Exception):
            raise ValueError(f"a worker cannot make rows of {name!r}: {type(origin).__name__}: {origin}")
        if origin != expected:
            raise ValueError(f"worker {worker} has {_told(origin)}: must be as here, {_told(expected)}")
