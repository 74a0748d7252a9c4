"""Stored rows made again: what they hold must come back, within each column's tolerance.

Rows of one study that differ in numbers alone stand or fall together: a change of code that moves one of them moves the
others. So an older row is borne out by the cheapest of its group, made again; where even that one takes long and only a
look is wanted, by those of groups that the same code makes (`groups.followed`).
"""

import math
import re
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from queue import SimpleQueue

from demheat.runtime.rows import each_kept
from studies.harness import provenance, runner
from studies.harness.forked import forking
from studies.harness.groups import by_itself, cheapest, cost, followed, group_of
from studies.harness.provenance import of_this_code
from studies.harness.sound import held, proved
from studies.harness.store import add_rows, case_key, check_writable, read_rows
from studies.harness.tolerance import moved

# Words of a row that wants a program which is not here.
ABSENT = re.compile(r"not installed|cannot be loaded|no mpiexec here|no Python (here has|with) ")
# And of one that took more memory than there was, beside another.
KILLED = "process killed by SIGKILL"
# Studies that are named.
MOST = 3
# Rows that are made side by side: their values count, not their costs.
WORKERS = 2


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
    """Make stored rows again and note in them if they came out the same; task, what moved, and row, as they come."""
    check_writable(out)
    with ExitStack() as stack:
        compute = compute or stack.enter_context(side_by_side())

        def keep(task, row):
            name, study, case = task
            path, key = runner.csv_of(name, out), case_key(case)
            if absent(row):
                return task, None, row
            stored = read_rows(path)[key]
            wrong = moved(name, study, case, stored, row)
            add_rows(path, {key: stamped(stored, row, wrong)}, keys_of(study, path))
            return task, wrong, row

        found = each_kept(tasks, enumerate(compute(tasks)), keep, what="replay")
        for number, (task, wrong, row) in enumerate(found, start=1):
            words = f"not here, {row['note']}" if wrong is None else moved_in_words(wrong)
            say(f"[{number}/{len(tasks)}] {task[0]} {case_key(task[2])}: {words}")
            if wrong is not None:
                yield task, wrong, row


def stamped(stored, row, wrong):
    """A stored row with a note that it came out the same, or that it moved: then `accept` makes its group again."""
    if wrong:
        return stored | {"moved_commit": row["commit"]}
    found = {"replayed_commit": row["commit"], "replayed_when": row["when"]}
    return stored | found | {name: "" for name in ("moved_commit",) if name in stored}


def absent(row):
    """Whether a row could not be made for want of somebody's program, or of memory: that says nothing of the stored."""
    missing = row["status"] == "unsupported" and bool(ABSENT.search(row["note"]))
    return missing or (row["status"] == "failed" and row["note"].startswith(KILLED))


def moved_in_words(wrong):
    """What has moved in a row, in words."""
    return "the same" if not wrong else "; ".join(f"{each.column} {each.stored} -> {each.found}" for each in wrong[:3])


def keys_of(study, path):
    """Cases of a study in order, then all others in its file: of guests, or of another version. None is lost."""
    return list(dict.fromkeys([*map(case_key, study.CASES), *read_rows(path)]))


def bear_out(studies, out, *, quick=False, dear=math.inf, say=print, compute=None):
    """Replay, of the rows that other code has made, the cheapest of each group; note in a group that is borne out.

    Groups whose cheapest row took more than `dear` seconds follow others. Returns those that moved, as pairs of a
    study's name and a group, and the rows that were made of them, by study and key.
    """
    groups = _grouped(studies, out, quick)
    older = {each: task for each, (task, _, _) in groups.items() if task}
    apart = {name: by_itself(study) for name, study in studies.items()}
    told_of = {each: seconds for each, (task, seconds, before) in groups.items() if task or before is not None}
    following = {each: leaders for each, leaders in followed(told_of, dear, apart).items() if each in older}
    known = {each: before for each, (task, _, before) in groups.items() if before or not task}
    tasks = [older[each] for each in sorted(older, key=told_of.get) if each not in following and each not in known]
    if older:
        say(f"{len(older)} groups have rows of other code; one row of each of {len(tasks)} is made again")
    for (name, group), leaders in following.items():
        kinds, others = case_key(dict(group)), sorted({other for other, _ in leaders})
        more = f" and {len(others) - MOST} more" if len(others) > MOST else ""
        say(f"    {name} {kinds} takes long: follows {', '.join(others[:MOST])}{more}")
    gone, made = dict(known), {}
    for task, wrong, row in replayed(tasks, out, say, compute=compute):
        name, group = each = task[0], group_of(task[1], task[2])
        gone[each] = bool(wrong)
        if wrong:
            made[name, case_key(task[2])] = row
        else:
            _mark(studies[name], runner.csv_of(name, out), group)
    for (name, group), leaders in following.items():
        if (name, group) in known:
            continue
        # A leader that is not here says nothing.
        found = [gone[each] for each in leaders if gone.get(each) is not None]
        gone[name, group] = any(found)
        if found and not any(found):
            _mark(studies[name], runner.csv_of(name, out), group)
    return {each for each in older if gone.get(each)}, made


def _grouped(studies, out, quick):
    """Of each group its cheapest row of other code, if any, as a task; its least seconds; whether it moved before."""
    found = {}
    for name, study in studies.items():
        rows, groups = read_rows(runner.csv_of(name, out)), {}
        for case in stored_cases(study, runner.csv_of(name, out), quick=quick):
            if rows[case_key(case)]["status"] in runner.KEPT:
                groups.setdefault(group_of(study, case), []).append(case)
        for group, cases in groups.items():
            here = [rows[case_key(case)] for case in cases]
            older = [case for case in cases if not held(study, rows[case_key(case)])]
            task = (name, study, cheapest(study, rows, older)[group]) if older else None
            least = cost(rows[case_key(cheapest(study, rows, cases)[group])])
            found[name, group] = task, least, _moved_before(study, here)
    return found


def _moved_before(study, rows):
    """Whether a replay by this code found a group moved, which is not all made again yet; None if there was none."""

    def here(*names):
        return any(of_this_code(str(row.get(name) or ""), study.__file__) for row in rows for name in names)

    if here("values_commit", "moved_commit"):
        return True
    return False if here("replayed_commit", "borne_commit") and not here("commit") else None


def _mark(study, path, group):
    """Note in the rows of a group that other code has made that they are borne out."""
    rows, mark = read_rows(path), {"borne_commit": provenance.commit(study.__file__)}
    keys = [case_key(case) for case in study.CASES if group_of(study, case) == group]
    found = {key: rows[key] | mark for key in keys if key in rows and not held(study, rows[key])}
    if found:
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
