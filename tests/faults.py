"""What happens to runs of studies when they are killed, run at one time, or on machines that lack something.

Each fault is tried on a real run, `python -m studies run`, of a study small enough; `tests/test_faults.py` tries the
cheap ones, `tests/tools/try_faults.py` all of them, and writes a page.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from studies.harness import store

ROOT = Path(__file__).parents[1]
# What two rows of one case may differ in.
COSTS = {*store.COST, "when", "load", "noise", "triad_gbs", "commit", "beside", store.MADE}
STUDY = '''"""A study to be killed.

Four rows, each of which starts a process of its own, as solvers do, and takes a while.
"""

import subprocess
import time

CASES = [{"name": "row", "x": float(k)} for k in range(5)]
REPEATS = 1


def QUICK(case):
    return case["x"] < 4


def run(name, x):
    child = subprocess.Popen(["sleep", "30"])
    time.sleep(0.1)
    child.kill()
    child.wait()
    return {"third": x / 3, "place": "Z\\u00fcrich, \\u00b0C"}


def claims(df):
    yield "thirds", df["third"].max(), 2.0
    yield "and others", df["third"].min(), 2.0
    yield "again", 0.0, 1.0


def plot(df):
    from matplotlib import pyplot

    figure, axes = pyplot.subplots()
    axes.plot(df["x"], df["third"])
    return figure
'''


class Toy:
    """The small study in a folder of its own."""

    name = "killed_study"

    def __init__(self, folder, text=STUDY):
        self.folder, self.out = Path(folder), Path(folder) / "out"
        (self.folder / f"{self.name}.py").write_text(text, encoding="utf-8")
        self.mark = f"FAULTS_{os.getpid()}_{id(self)}"

    def words(self, *options, python=()):
        """The command of a quick run."""
        words = ["run", self.name, "--quick", "--out", str(self.out), "--wait", "0"]
        return [sys.executable, *python, "-m", "studies", *words, *options]

    def environment(self, **changes):
        """Variables of a run, its mark among them; None takes one away."""
        found = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(self.folder)]), self.mark: "1"}
        found |= {name: value for name, value in changes.items() if value is not None}
        return {name: value for name, value in found.items() if changes.get(name, "") is not None}

    def start(self, *options, python=(), **changes):
        """Begin a run."""
        return subprocess.Popen(
            self.words(*options, python=python),
            cwd=self.folder,
            env=self.environment(**changes),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )

    def run(self, *options, python=(), **changes):
        """A whole run: status, standard output and standard error, as text."""
        process = self.start(*options, python=python, **changes)
        out, error = process.communicate(timeout=600)
        return process.returncode, out.decode("utf-8", "replace"), error.decode("utf-8", "replace")

    def rows(self):
        """Rows as stored, without costs: {case: {column: text}}."""
        rows = store.read_rows(self.out / f"{self.name}.csv")
        return {key: {k: v for k, v in row.items() if k not in COSTS} for key, row in rows.items()}

    def running(self):
        """Numbers of all processes that a run has started and that are still there."""
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                marked = self.mark.encode() + b"=" in (folder / "environ").read_bytes()
                dead = (folder / "stat").read_text().rsplit(")", 1)[1].split()[0] in "ZX"
            except (OSError, IndexError):
                continue
            if marked and not dead:
                found.append(int(folder.name))
        return found

    def gone(self, seconds=20.0):
        """Whether all of them end by themselves."""
        end = time.monotonic() + seconds
        while self.running():
            if time.monotonic() > end:
                return False
            time.sleep(0.05)
        return True

    def clear(self):
        """End what a failed test has left."""
        for number in self.running():
            os.kill(number, signal.SIGKILL)


def killed(toy, moment, group):
    """Start a run, kill it after some seconds, and say what is wrong then."""
    process = toy.start()
    try:
        process.wait(moment)
    except subprocess.TimeoutExpired:
        (os.killpg if group else os.kill)(process.pid, signal.SIGKILL)
    # Nothing is read before: what a run says here fits into the pipe.
    process.stdout.close()
    process.stderr.close()
    process.wait()
    return [] if toy.gone() else [f"still running: {toy.running()}"], process.returncode


def compared(toy, right, before):
    """What is wrong with the rows there: lost since, or other than those of a run that nobody killed."""
    rows = toy.rows()
    wrong = [f"lost: {key}" for key in before if key not in rows]
    return wrong + [f"wrong: {key}: {row}" for key, row in rows.items() if row != right[key]]


def unkilled(folder):
    """Rows of a run that nobody disturbs, and how long it lasts, s."""
    Path(folder).mkdir()
    toy, begin = Toy(folder), time.monotonic()
    status, _, said = toy.run()
    assert status == 0, said
    return toy.rows(), time.monotonic() - begin
