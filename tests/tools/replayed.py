"""Choose the rows that `make test` replays: at most so many CPU-seconds, and every file that makes numbers executed.

    python tests/tools/replayed.py [--seconds 100] [--measured FILE]

Each quick row is made once in a process of its own that notes which files of `demheat` and `references` it executes,
kernels included; then rows are chosen one by one, that which brings the most for its time first, until each study,
method, law and integrator with a quick row, and each such file, has one. The choice is written to
`tests/studies/replayed.csv`, what it executes to `executed.txt` beside it; measurements are kept in FILE, so that a
killed run goes on. One row after another costs less than in processes of their own: a half.
"""

import argparse
import csv
import json
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
PACKAGES = tuple(str(ROOT / name) + os.sep for name in ("demheat", "references"))
CHOSEN = ROOT / "tests" / "studies" / "replayed.csv"
LIBRARIES = ("numba.np.ufunc.parallel", "skfem", "pyfftw", "pyamg", "scipy.optimize", "scipy.spatial", "pandas")
# Parameters of a case of which each value wants a row.
KINDS = ("name", "method", "law", "integrator", "scheme", "rule")
# A method is the same in a column of names.
SAME = {"name": "method"}
# What a row may cost that brings no more than another kind in its study; other quick rows are for `make test-slow`.
EXTRA = 0.1


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=100.0, help="CPU time of all chosen rows together")
    parser.add_argument("--measured", type=Path, default=ROOT / "out" / "replayed.jsonl")
    arguments = parser.parse_args(words)
    from studies.harness.store import case_key

    cases = {(name, case_key(case)): case for name, case in quick_rows()}
    known = measured(arguments.measured)
    found = {pair: known[pair] | {"kinds": kinds(cases[pair])} for pair in known if pair in cases}
    chosen, lacking = choose(found, arguments.seconds)
    pairs = {(row["study"], row["case"]) for row in chosen}
    files = {name for pair, each in found.items() if pair in pairs for name in each["files"]}
    CHOSEN.with_name("executed.txt").write_text("".join(f"{name}\n" for name in sorted(files)), encoding="utf-8")
    with CHOSEN.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, ("study", "case", "cpu_s"), lineterminator="\n")
        writer.writeheader()
        writer.writerows(chosen)
    print(f"{CHOSEN}: {len(chosen)} rows, {sum(row['cpu_s'] for row in chosen):.0f} CPU-s")
    print(*(f"not reached: {word}" for word in sorted(lacking)), sep="\n")


def quick_rows():
    """Pairs (study, case) of all quick rows."""
    from studies.__main__ import study_names
    from studies.harness import runner

    for name in study_names():
        study = runner.load(name)
        yield from ((name, case) for case in study.CASES if study.QUICK(case))


def measured(path):
    """What each quick row costs and executes, by (study, case); rows that are not in the file yet are made."""
    from studies.harness.store import case_key

    path.parent.mkdir(parents=True, exist_ok=True)
    found = {}
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            each = json.loads(line)
            found[each["study"], each["case"]] = each
    todo = [(name, case) for name, case in quick_rows() if (name, case_key(case)) not in found]
    _load()
    with ThreadPoolExecutor(2) as pool, path.open("a", encoding="utf-8") as file:
        for number, each in enumerate(pool.map(lambda pair: _apart(*pair), todo), start=1):
            file.write(json.dumps(each) + "\n")
            file.flush()
            found[each["study"], each["case"]] = each
            print(f"[{number}/{len(todo)}] {each['study']} {each['case'][:80]}: {each['cpu_s']:.2f} CPU-s", flush=True)
    return found


def _load():
    import importlib

    for name in LIBRARIES:
        importlib.import_module(name)


def _apart(name, case):
    """Make a row in a copy of this process."""
    reading, writing = os.pipe()
    pid = os.fork()
    if not pid:
        os.close(reading)
        try:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            text = json.dumps(_traced(name, case), default=lambda value: value.item())
            with os.fdopen(writing, "w") as stream:
                stream.write(text)
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as stream:
        text = stream.read()
    os.waitpid(pid, 0)
    return json.loads(text)


def _traced(name, case):
    from studies.harness import runner
    from studies.harness.store import case_key

    study, files = runner.load(name), set()

    def note(frame, event, argument):
        # A module's own statements run when it is imported: that is not its work.
        if event == "call" and frame.f_code.co_name != "<module>":
            files.add(frame.f_code.co_filename)

    begin = time.process_time()
    sys.setprofile(note)
    try:
        row = runner.compute_row(study, case, warm=False)
    finally:
        sys.setprofile(None)
    spent = time.process_time() - begin
    files = {name for name in files if name.startswith(PACKAGES)} | set(_kernels())
    return {
        "study": name,
        "case": case_key(case),
        "cpu_s": round(spent, 3),
        "row": row,
        "files": sorted(os.path.relpath(path, ROOT) for path in files),
    }


def _kernels():
    """Files of the kernels that this process has compiled or loaded."""
    from numba.core.dispatcher import Dispatcher

    for module in list(sys.modules.values()):
        path = getattr(module, "__file__", None) or ""
        if path.startswith(PACKAGES):
            for value in list(vars(module).values()):
                if isinstance(value, Dispatcher) and value.overloads:
                    yield value.py_func.__code__.co_filename


def kinds(case):
    """The parameters of a case that tell which code makes its row."""
    return [f"{SAME.get(kind, kind)} {case[kind]}" for kind in KINDS if case.get(kind)]


def wants(each):
    """What a row must bring: its study, its kinds, the files that it executes."""
    return {f"study {each['study']}", *each["kinds"], *each["files"]}


def more(each):
    """What it may bring besides: its kinds in its study."""
    return {f"{each['study']} {kind}" for kind in each["kinds"]}


def choose(found, seconds):
    """Rows that together bring all they must, then what they may, and what is not reached within the time."""
    ok = [each for each in found.values() if each["row"]["status"] in ("ok", "unsupported")]
    chosen, lacking = [], set()
    for brings in (wants, more):
        left = set().union(*map(brings, ok)) - set().union(*map(brings, chosen))
        spare = [each for each in ok if each not in chosen and (brings is wants or each["cpu_s"] <= EXTRA)]
        while left and spare:
            best = max(spare, key=lambda each: len(brings(each) & left) / (0.02 + each["cpu_s"]))
            if not brings(best) & left:
                break
            spare.remove(best)
            if best["cpu_s"] <= seconds:
                seconds -= best["cpu_s"]
                left -= brings(best)
                chosen.append(best)
        lacking |= left if brings is wants else set()
    names = ("study", "case", "cpu_s")
    return [{name: each[name] for name in names} for each in chosen], lacking


if __name__ == "__main__":
    main()
