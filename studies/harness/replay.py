"""Stored rows made again: what they hold must come back, within each column's tolerance.

Rows of one study that share a method, a law and the like stand or fall together: a change of code that moves one of
them moves the others. So an older row is borne out by the cheapest of its group, made again.
"""

from __future__ import annotations

import math
import re
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from queue import SimpleQueue

from studies.harness import provenance, runner
from studies.harness.forked import forking
from studies.harness.sound import held, proved
from studies.harness.store import MADE, add_rows, case_key, check_writable, read_rows
from studies.harness.tolerance import moved

# Parameters of a case that say which code makes its row, and not how much of it.
KINDS = ("part", "name", "method", "law", "integrator", "scheme", "rule", "packing", "held", "family")
# Words of a row that wants a program which is not here.
ABSENT = re.compile(r"not installed|no mpiexec here")
# Rows that are made side by side: their values count, not their costs.
WORKERS = 2


def group_of(case):
    """What a row stands or falls with, in its study."""
    return tuple((kind, case[kind]) for kind in KINDS if case.get(kind) is not None)


def cheapest(rows, cases):
    """Of each group the case whose stored row took least."""
    found = {}
    for case in sorted(cases, key=lambda case: _cost(rows.get(case_key(case), {}))):
        found.setdefault(group_of(case), case)
    return found


def _cost(row):
    try:
        return float(row.get("wall_s") or row.get(MADE) or math.inf)
    except ValueError:
        return math.inf


@contextmanager
def side_by_side(workers=WORKERS):
    """Have rows made for their values, several at a time, one thread each."""
    with ExitStack() as stack:
        free = SimpleQueue()
        for _ in range(workers):
            free.put(stack.enter_context(forking(values=True, count=1)))
        pool = stack.enter_context(ThreadPoolExecutor(workers))

        def made(task):
            compute = free.get()
            try:
                return compute(*task)
            finally:
                free.put(compute)

        def each(tasks):
            futures = [pool.submit(made, task) for task in tasks]
            try:
                for future in futures:
                    yield future.result()
            finally:
                for future in futures:
                    future.cancel()

        yield each


def replayed(tasks, out, say, *, compute=None):
    """Make stored rows again and note in them when they came out the same."""
    found = []
    check_writable(out)
    with ExitStack() as stack:
        compute = compute or stack.enter_context(side_by_side())
        for number, (task, row) in enumerate(zip(tasks, compute(tasks), strict=True), start=1):
            name, study, case = task
            path, key = runner.csv_of(name, out), case_key(case)
            stored = read_rows(path)[key]
            if absent(row):
                say(f"[{number}/{len(tasks)}] {name} {key}: not here, {row['note']}")
                continue
            wrong = moved(name, study, case, stored, row)
            if not wrong:
                stamp = {"replayed_commit": row["commit"], "replayed_when": row["when"]}
                add_rows(path, {key: stored | stamp}, keys_of(study, path))
            found.append((task, wrong))
            say(f"[{number}/{len(tasks)}] {name} {key}: {told(wrong)}")
    return found


def absent(row):
    """Whether a row could not be made for want of a program that is not ours: that says nothing of the stored one."""
    return row["status"] == "unsupported" and bool(ABSENT.search(row["note"]))


def told(wrong):
    """What has moved in a row, in words."""
    return "the same" if not wrong else "; ".join(f"{each.column} {each.stored} -> {each.found}" for each in wrong[:3])


def keys_of(study, path):
    """Cases of a study in order, then all others in its file: of guests, or of another version. None is lost."""
    return list(dict.fromkeys([*map(case_key, study.CASES), *read_rows(path)]))


def bear_out(name, out, *, quick=False, say=print, compute=None):
    """Replay, of the rows that other code has made, the cheapest of each group; note in a group that is borne out."""
    study, path = runner.load(name), runner.csv_of(name, out)
    rows = read_rows(path)
    cases = [case for case in stored_cases(study, path, quick=quick) if rows[case_key(case)]["status"] in runner.KEPT]
    older = [case for case in cases if not held(study, rows[case_key(case)])]
    if not older:
        return
    chosen = cheapest(rows, older)
    say(f"{name}: {len(older)} rows of other code; one of each of {len(chosen)} groups is made again")
    tasks = [(name, study, case) for case in chosen.values()]
    same = {group_of(task[2]) for task, wrong in replayed(tasks, out, say, compute=compute) if not wrong}
    rows, mark = read_rows(path), {"borne_commit": provenance.commit(study.__file__)}
    found = {case_key(case): rows[case_key(case)] | mark for case in older if group_of(case) in same}
    add_rows(path, found, keys_of(study, path))


def stored_cases(study, path, *, quick=False, unproved=False):
    """Cases of a study with a stored row."""
    rows = read_rows(path)
    cases = [case for case in study.CASES if case_key(case) in rows and (study.QUICK(case) or not quick)]
    return [case for case in cases if not (unproved and proved(study, rows[case_key(case)]))]


def lacking(study, path):
    """Keys of cases without a stored row."""
    rows = read_rows(path)
    return [key for key in map(case_key, study.CASES) if key not in rows]
