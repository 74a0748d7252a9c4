"""Run a study: each case in a process of its own, timed after a warm-up, kept row by row.

A study is a module with

- `CASES`, a list of dicts of plain values, the parameters of each row; "method", if present, names a
  method, or what the study's `MODULES` says of that name;
- `QUICK(case)`, true for the cases of a quick run;
- `run(**case)`, a dict of metrics; costs it measures itself (`cost.measured`) replace the whole run's, and a "status"
  with a "note" says of a refusal that it is one;
- `claims(df)`, pairs of a sentence with a value, None where its rows do not exist, and a limit;
- optionally `plot(df)`, a figure where one says more than the table: without, it is one of the claims; `VALUES(case)`,
  true for the cases of which nobody asks what they cost, or `VALUES = True` for all: rows have none, and are made side
  by side;
  `warm_up(**case)`, untimed; `again(**case)`, of a row that is made for its values alone what is no matter of costs,
  where not all of `run` is; `table(df)`, what to print, with its docstring as caption; `notes(df)`, sentences below it
  that are made of the rows; `words(df)`, what other pages say of it; `TIMEOUT`, seconds per row;
  `BY_ITSELF`, parameters of which no value's rows are borne out by another's (`groups`);
  `TOLERANCES`, by columns how near values must come that are made again (`tolerance.TOLERANCES`), and `COMPARED_AS`, of
  columns whose cells hold more than values, text -> what of it is compared;
  `REPEATS`, how often a short `run` is called at most (`repeated.RUNS`); `COSTS`, columns of costs that are not called
  so (`sound.COSTS`); `REASONS`, by words of a claim's sentence why its limit is no nearer to the value (more than three
  times needs one, and `tests/studies/test_claims_can_fail.py` asks for it); `FAILS`, in the same way why claims on the
  stored rows fail, or that nobody knows (asked for, too);
- where it takes methods that are not ours, `guests(method, quick=)`, the cases of one, and `guest_case(key)`, such a
  case by its key alone, None if it is none: rows of a guest stay, and are drawn, when it is no longer there.

One that is too long for a file is a folder of its name. These stand in `__init__`; what computes is in `rows`, what is
made of rows in `errors` or `means`, `table` in `tables`, `plot` in `figure`: where such a function needs no more than
the rows, `__init__` names its file to `lazy_names`, and no row's process loads it. Errors are defined by
`demheat.referee` alone.
"""

import importlib
import json
import os
import sys
import time
import traceback
from pathlib import Path

from demheat.runtime import fresh
from demheat.runtime.machine import machine
from demheat.runtime.paths import replaced
from demheat.runtime.rows import each_kept
from demheat.scene.inputs import one_line
from studies.harness import quiet
from studies.harness.beside import counted
from studies.harness.cost import measured
from studies.harness.provenance import ANYWHERE, SAME, guest_case, provenance, threads, versions
from studies.harness.repeated import RUNS, measured_again
from studies.harness.sound import checked, cost_columns, held, values_only
from studies.harness.store import COST, MADE, TAIL, add_rows, case_key, check_writable, read_rows

TIMEOUT = 1800.0
KEPT = ("ok", "unsupported")  # a failed or timed-out row is tried again


def load(name):
    """Module of a study: `studies.NAME`, or any importable module that has CASES."""
    if not all(part.isidentifier() for part in name.split(".")):
        raise ValueError(f"no study {name!r}; must be a name, and `python -m studies list` shows them all")
    for path in (f"studies.{name}", name):
        try:
            study = importlib.import_module(path)
        except ModuleNotFoundError as error:
            if error.name is not None and path.startswith(error.name):
                continue
            raise
        if hasattr(study, "CASES"):
            keys = [case_key(case) for case in study.CASES]
            if len(set(keys)) < len(keys):
                raise ValueError(f"study {name!r}: two cases have the same parameters")
            taken = sorted({key for case in study.CASES for key in case} & set(TAIL))
            if taken:
                raise ValueError(f"study {name!r}: parameters {taken} of its cases are columns that every row has")
            return study
    raise ValueError(f"no study {name!r}; `python -m studies list` shows them all")


def find_case(study, case):
    """Case of a study by its key, or by its number in CASES; FURTHER are those that its record does not hold."""
    cases = {case_key(each): each for each in (*study.CASES, *getattr(study, "FURTHER", ()))}
    guest = guest_case(study, case)
    if guest is not None:
        return guest
    # Not of thousands of digits, which Python refuses to read.
    if case.isdecimal() and len(case) < 10 and int(case) < len(study.CASES):
        return study.CASES[int(case)]
    if case not in cases:
        raise ValueError(f"no case {case!r}; the first of {len(cases)} is {next(iter(cases), None)!r}")
    return cases[case]


def run_study(name, out, *, quick=False, force=False, method=None, say=print, compute=None, spread=None):
    """Bring DIR/NAME.csv up to date and return its path.

    Rows that the present code has made or borne out (`replay.bear_out`), on this machine, are reused, unless forced.
    Rows of cases that are not asked for now (a full run's, in a quick one) stay.
    """
    study = load(name)
    path = csv_of(name, out)
    cases = guests_of(name, method, quick=quick) if method else None
    same = ANYWHERE if spread else SAME
    wanted, todo = still_to_run(study, path, cases, quick=quick, force=force or method is not None, same=same)
    rows, made = read_rows(path), {}
    kept = [key for key in rows if guest_case(study, key) is not None]
    keys = list(dict.fromkeys([*map(case_key, study.CASES), *kept, *map(case_key, wanted)]))
    say(f"{name}: {len(wanted)} rows, {len(wanted) - len(todo)} already there, {len(todo)} to run")
    if not todo:
        return path
    check_writable(path.parent)
    compute = compute or quiet.quietly(spawn_row, say=say)
    todo.sort(key=lambda case: not values_only(study, case))
    arriving = spread(name, study, todo) if spread else enumerate(_made(name, study, todo, compute))
    start = time.perf_counter()

    def keep(_, row):
        made[row["case"]] = row
        add_rows(path, made, keys)
        return row

    # Rows of a cluster come in no order.
    named = {} if spread else {"named": lambda case: f", {_short(case_key(case))}"}
    for number, row in enumerate(each_kept(todo, arriving, keep, what=name, **named), start=1):
        say(_progress(number, len(todo), row, time.perf_counter() - start))
    return path


def _made(name, study, todo, compute):
    """Rows for their values alone first, side by side, which compile what the others load; then those, in order."""
    beside = getattr(compute, "beside", None)
    together = [case for case in todo if beside and values_only(study, case)]
    if together:
        yield from beside([(name, study, case) for case in together])
    yield from (compute(name, study, case) for case in todo[len(together) :])


def guests_of(name, method, *, quick=False):
    """Cases of a method that is not ours, in a study that takes such."""
    study = load(name)
    if not hasattr(study, "guests"):
        raise ValueError(f"method = {method!r}: study {name} takes no methods but ours; sphere_benchmark does")
    return study.guests(method, quick=quick)


def csv_of(name, out):
    """Path of a study's rows in a folder."""
    return Path(out) / f"{name.rsplit('.', 1)[-1]}.csv"


def still_to_run(study, path, cases=None, *, quick=False, force=False, same=SAME):
    """Cases that are asked for, and those of them without a row that holds."""
    rows = read_rows(path)
    wanted = [case for case in study.CASES if not quick or study.QUICK(case)] if cases is None else cases
    here = {"machine": machine(), "threads": threads(), "versions": versions()}
    here = {name: str(here[name]) for name in same}
    wrong = checked(study, path) if force == "unsound" else {}

    def holds(case):
        row = rows.get(case_key(case))
        # Values do not depend on the machine.
        asked = [name for name in same if name in ANYWHERE or not values_only(study, case)]
        kept = row is not None and row.get("status") in KEPT and all(row.get(name) == here[name] for name in asked)
        return kept and held(study, row) and not (wrong.get(row["case"]) if force == "unsound" else force)

    return wanted, [case for case in wanted if not holds(case)]


def _progress(number, total, row, elapsed):
    left = elapsed / number * (total - number)
    error = row.get("error_percent")
    tail = f", error {error:+.4f} %" if isinstance(error, float) else f", {row['note']}" if row["note"] else ""
    cost = f"{row['cpu_s']:.2f} CPU-s" if isinstance(row.get("cpu_s"), float) else "no cost"
    head = f"[{number}/{total}] {_short(row['case'])}: {row['status']}, {cost}{tail}"
    return f"{head}  ({elapsed:.0f} s so far, about {left:.0f} s left)"


def _short(key):
    """A case without what its method fixes, which comes last."""
    return key.split(",method=")[0]


def spawn_row(name, study, case, *, start=None, values=False):
    """Compute a row in a process of its own; whatever happens to that process, a row comes back."""
    words, begin = ["row", name, case_key(case), *(["--values"] if values else []), "--json"], time.perf_counter()
    try:
        row = fresh.answer_of(words, limit=getattr(study, "TIMEOUT", TIMEOUT), start=start or started)
    except TimeoutError as error:
        return failed(study, case, error, status="timeout")
    except ChildProcessError as error:
        return failed(study, case, error)
    return row | {MADE: round(time.perf_counter() - begin, 3)}


def failed(study, case, why, *, status="failed"):
    """Row of a case that did not come to an end."""
    return {"case": case_key(case), **case, "status": status, "note": one_line(why), **provenance(study)}


def started(words, log, *, limit, environment=None):
    """Start Python for a row."""
    words = [sys.executable, "-m", "studies", *words, "--parent", str(os.getpid())]
    return fresh.run(words, log, limit=limit, environment=environment)


def compute_row(study, case, *, warm=True):
    """Compute a row in this process: the case, its metrics, costs and provenance."""
    row, alone = {"case": case_key(case), **case}, values_only(study, case)
    warm = warm and not alone
    try:
        if warm and hasattr(study, "warm_up"):
            study.warm_up(**case)
        with counted() as beside:
            metrics, cost = _quietly_measured(study, case) if warm else measured(_for_values(study), **case)
    except NotImplementedError as error:
        result = {"status": "unsupported", "note": str(error)}
    except Exception as error:
        traceback.print_exc()
        place = traceback.extract_tb(error.__traceback__)[-1]
        note = f"{type(error).__name__} in {place.name}: {error}"
        result = {"status": "failed", "note": " ".join(note.split())}
    else:
        # A method may repeat what it was given, or have nothing to say of it.
        clash = sorted(key for key in set(metrics) & set(row) if metrics[key] not in (None, row[key]))
        if clash:
            raise ValueError(f"run() of {study.__name__} returns {clash}, which are parameters of its case")
        result = {"status": "ok", "note": "", **cost, **beside, **metrics}
        if alone:
            for name in {*cost_columns(study, result), *COST, "beside"} & set(result):
                del result[name]
    return {**row, **result, **row, **provenance(study)}


def _for_values(study):
    """What makes a row whose costs do not count: of a search, which goes by costs, what of it does not."""
    return getattr(study, "again", study.run)


def _quietly_measured(study, case):
    """A run's metrics and costs, with what of its time was not its own: see `quiet`."""
    before, begin = quiet.others(quiet.START), quiet.moment()
    with quiet.compiling() as spent:
        metrics, cost = measured_again(study.run, case, most=getattr(study, "REPEATS", RUNS))
    noise = quiet.loudest(before, quiet.others(begin))
    # Of several calls the cheapest counts, and the first compiles.
    compiled = {"compile_s": sum(spent)} if spent and cost["repeats"] == 1 else {}
    return metrics, cost | compiled | ({"noise": noise} if noise == noise else {})


def write_json(row, path):
    """Hand a row over to the process that asked for it."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        temporary.write_text(json.dumps(row, default=lambda value: value.item()), encoding="utf-8")
