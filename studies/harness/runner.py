"""Run a study: each case in a fresh process, timed after a warm-up, kept row by row.

A study is a module with

- `CASES`, a list of dicts of plain values, the parameters of each row; "method", if present, names a
  method, or what the study's `MODULES` says of that name;
- `QUICK(case)`, true for the cases of a quick run;
- `run(**case)`, a dict of metrics; costs it measures itself (`cost.measured`) replace the whole run's, and a "status"
  with a "note" says of a refusal that it is one;
- `claims(df)`, pairs of a sentence with a value and a limit; `plot(df)`, a figure; `PAPER`, what the paper prints;
- optionally `warm_up(**case)`, untimed; `table(df)`, what to print, with its docstring as caption; `notes(df)`,
  sentences below it that are made of the rows; and `TIMEOUT`, seconds per row;
- where it takes methods that are not ours, `guests(method, quick=)`, the cases of one, and `guest_case(key)`, such a
  case by its key alone, None if it is none: rows of a guest stay, and are drawn, when it is no longer there.

One that is too long for a file is a folder of its name. These stand in `__init__`; what computes is in `rows`, what is
made of rows in `errors` or `means`, lines of the table in `tables`, the drawing in `figure`. Errors are defined by
`demheat.referee` alone.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path

from demheat.progress import stage
from studies.harness.cost import measured, triad_gbs
from studies.harness.provenance import SAME, code_hash, module_of, provenance
from studies.harness.store import TAIL, add_rows, case_key, check_writable, read_rows

TIMEOUT = 1800.0
KEPT = ("ok", "unsupported")  # a failed or timed-out row is tried again


def load(name):
    """Module of a study: `studies.NAME`, or any importable module that has CASES.

    Raises
    ------
    ValueError
        If there is no such study, two of its cases have the same parameters, or one is called as a column that every
        row has.
    """
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
    """Case of a study by its key, or by its number in CASES.

    Parameters
    ----------
    study : module
    case : str

    Returns
    -------
    dict
    """
    cases = {case_key(each): each for each in study.CASES}
    guest = guest_case(study, case)
    if guest is not None:
        return guest
    # Not of thousands of digits, which Python refuses to read.
    if case.isdecimal() and len(case) < 10 and int(case) < len(study.CASES):
        return study.CASES[int(case)]
    if case not in cases:
        raise ValueError(f"no case {case!r}; the first of {len(cases)} is {next(iter(cases), None)!r}")
    return cases[case]


def guest_case(study, key):
    """Case of a method that is not ours, by its key; None if the study takes no such, or it is no such key.

    Parameters
    ----------
    study : module
    key : str
    """
    return study.guest_case(key) if hasattr(study, "guest_case") else None


def run_study(name, out, *, quick=False, force=False, method=None, say=print, compute=None):
    """Bring DIR/NAME.csv up to date and return its path.

    Rows whose case, code, machine, threads and versions still hold are reused, unless forced. Rows of cases that are
    not asked for now (a full run's, in a quick one) stay.

    Parameters
    ----------
    name : str
    out : path
    quick : bool
        Only the cases that QUICK accepts.
    force : bool
        Repeat every row.
    method : str, optional
        One that is not ours: its rows alone are run, and each anew, as nothing here knows when its code has changed.
    say : callable (str)
        Told of each row as it ends.
    compute : callable (name, study, case) -> dict
        Default `spawn_row`: each row in a fresh process, so that its cost means something.

    Raises
    ------
    ValueError
        If there is no such study, or its file cannot be read or written.
    """
    compute = compute or spawn_row
    study = load(name)
    path = Path(out) / f"{name.rsplit('.', 1)[-1]}.csv"
    rows, made = read_rows(path), {}
    if method is None:
        wanted = [case for case in study.CASES if not quick or study.QUICK(case)]
    else:
        wanted = guests_of(name, method, quick=quick)
    again = force or method is not None
    todo = [case for case in wanted if again or not _holds(rows.get(case_key(case)), study, case)]
    kept = [key for key in rows if guest_case(study, key) is not None]
    keys = list(dict.fromkeys([*map(case_key, study.CASES), *kept, *map(case_key, wanted)]))
    say(f"{name}: {len(wanted)} rows, {len(wanted) - len(todo)} already there, {len(todo)} to run")
    if todo:
        check_writable(path.parent)
    bandwidth = round(triad_gbs(), 1) if todo else None
    start = time.perf_counter()
    for number, case in enumerate(todo, start=1):
        key = case_key(case)
        with stage(f"{name} {number}/{len(todo)}, {_short(key)}", before=time.perf_counter() - start) as done:
            done((number - 1) / len(todo))
            made[key] = {**compute(name, study, case), "triad_gbs": bandwidth}
        add_rows(path, made, keys)
        say(_progress(number, len(todo), made[key], time.perf_counter() - start))
    return path


def guests_of(name, method, *, quick=False):
    """Cases of a method that is not ours, in a study that takes such.

    Parameters
    ----------
    name : str
        Of the study.
    method : str
    quick : bool

    Raises
    ------
    ValueError
        If the study takes none, or there is no such method.
    """
    study = load(name)
    if not hasattr(study, "guests"):
        raise ValueError(f"method = {method!r}: study {name} takes no methods but ours; sphere_benchmark does")
    return study.guests(method, quick=quick)


def state(study, rows):
    """How many of a study's cases have a stored row that the code beside it would give again.

    Only the code counts here: rows that were measured on another machine are no less its own, though `run_study` would
    repeat them.

    Parameters
    ----------
    study : module
    rows : dict of str to dict
        From `store.read_rows`.

    Returns
    -------
    dict of str to int
        "held", "stale" (made by other code) and "missing".
    """
    found = dict.fromkeys(("held", "stale", "missing"), 0)
    for case in study.CASES:
        row = rows.get(case_key(case))
        code = code_hash(study.__file__, module_of(study, case.get("method", "")))
        found["missing" if row is None else "held" if row.get("code") == code else "stale"] += 1
    return found


def _holds(row, study, case):
    if row is None or row.get("status") not in KEPT:
        return False
    now = provenance(study, case)
    return all(row.get(name) == str(now[name]) for name in SAME)


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


def spawn_row(name, study, case):
    """Compute a row in a fresh process; whatever happens to that process, a row comes back.

    Parameters
    ----------
    name : str
        Of the study.
    study : module
    case : dict

    Returns
    -------
    dict
        Its status says what happened: "ok", "unsupported", "failed" or "timeout".
    """
    key, limit = case_key(case), getattr(study, "TIMEOUT", TIMEOUT)
    base = {"case": key, **case}
    with tempfile.TemporaryDirectory() as folder:
        answer, log = Path(folder) / "row.json", Path(folder) / "log"
        with log.open("wb") as stream:
            words = ["row", name, key, "--json", str(answer), "--parent", str(os.getpid())]
            process = subprocess.Popen(
                [sys.executable, "-m", "studies", *words], stdout=stream, stderr=stream, start_new_session=True
            )
            watch = _watch(process)
            try:
                code = process.wait(limit)
            except subprocess.TimeoutExpired:
                note = f"not finished after {limit:g} s"
                return {**base, "status": "timeout", "note": note, **provenance(study, case)}
            finally:
                _end(process)
                _dismiss(watch)
        try:
            return json.loads(answer.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            note = f"{_end_of(code)}; {_last_line(log)}"
            return {**base, "status": "failed", "note": note, **provenance(study, case)}


def _watch(process):
    """Have a shell end a row's process and all that it started if this process is killed; None without a shell.

    The kernel ends the row's process then, see `die_with_parent`, but not what that has started. The shell hears of it
    by the end of a pipe of which nobody else holds the other end.
    """
    words = ["sh", "-c", 'read word; kill -9 -"$0"', str(process.pid)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        return subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True, **quiet)
    except OSError:
        return None


def _dismiss(watch):
    if watch is not None:
        watch.kill()
        watch.wait()
        watch.stdin.close()


def _end(process):
    """Kill the row's process and all that it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass
    process.wait()


def _end_of(code):
    return f"process killed by {signal.Signals(-code).name}" if code < 0 else f"process ended with status {code}"


def _last_line(log):
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return lines[-1][:300] if lines else "nothing on its output"


def compute_row(study, case, *, warm=True):
    """Compute a row in this process: the case, its metrics, costs and provenance.

    Parameters
    ----------
    study : module
    case : dict
    warm : bool
        Call the study's warm-up first; without it costs include what is loaded on first use.
    """
    row = {"case": case_key(case), **case}
    try:
        if warm and hasattr(study, "warm_up"):
            study.warm_up(**case)
        metrics, cost = measured(study.run, **case)
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
        result = {"status": "ok", "note": "", **cost, **metrics}
    return {**row, **result, **row, **provenance(study, case)}


def write_json(row, path):
    """Hand a row over to the process that asked for it.

    Parameters
    ----------
    row : dict
    path : path
    """
    Path(path).write_text(json.dumps(row, default=lambda value: value.item()), encoding="utf-8")


def die_with_parent(parent):
    """Have the kernel kill this process when its parent dies (Linux): a killed run leaves no solve behind.

    Parameters
    ----------
    parent : int
        Process number of the parent; if it is gone already, the process ends here.
    """
    try:
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # 1 = PR_SET_PDEATHSIG
    except (OSError, AttributeError):
        return
    if os.getppid() != parent:
        os._exit(1)
