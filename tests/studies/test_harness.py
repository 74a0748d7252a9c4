"""The harness of the studies, on a study small enough to break on purpose."""

import csv
import importlib
import os
import shutil
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from studies.__main__ import main, study_names
from studies.harness import cost, methods, provenance, runner, store, table

TINY = '''
"""A tiny study.

Text below the title.
"""
import os, time
CASES = [{"name": "plain", "x": 1.5}, {"name": "second", "x": 2.0}, *EXTRA]
PAPER = {}
TIMEOUT = 1.5

def QUICK(case):
    return case["x"] < 2

def warm_up(name, x):
    _log("warm " + name)

def run(name, x):
    _log("run " + name)
    if name == "refuses":
        raise NotImplementedError("not for x = 3")
    if name == "raises":
        raise RuntimeError("no convergence\\nafter 7 iterations")
    if name == "dies":
        os.abort()
    if name == "sleeps":
        time.sleep(60)
    if name == "slow":
        time.sleep(0.3)
    return {"square": x * x, "layer": os.environ["NUMBA_THREADING_LAYER"], "spin": os.environ["OMP_WAIT_POLICY"]}

def _log(word):
    with open(os.environ["TINY_LOG"], "a") as file:
        file.write(word + "\\n")

def claims(df):
    yield "squares are small", df["square"].max(), LIMIT

def plot(df):
    from matplotlib import pyplot
    figure, axes = pyplot.subplots()
    axes.plot(df["x"], df["square"])
    return figure
'''


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """Make a tiny study of its own name; returns the things a test asks about it."""
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("TINY_LOG", str(tmp_path / "log"))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(runner, "triad_gbs", lambda: 12.5)
    name = f"tiny_{tmp_path.name}"
    file, out = tmp_path / f"{name}.py", tmp_path / "out"

    def write(extra="", limit=100, **changes):
        text = TINY.replace("*EXTRA", extra).replace("LIMIT", repr(limit))
        for old, new in changes.items():
            assert old in text
            text = text.replace(old, new)
        file.write_text(text)
        sys.modules.pop(name, None)
        provenance.code_hash.cache_clear()
        provenance._parse.cache_clear()

    def run(*options):
        (tmp_path / "log").write_text("")
        return main(["run", name, "--out", str(out), *options])

    def ran(**options):
        """Bring the rows up to date, without a page or figure, and say which were run."""
        (tmp_path / "log").write_text("")
        runner.run_study(name, out, say=lambda line: None, **options)
        return [line[4:] for line in (tmp_path / "log").read_text().split("\n") if line.startswith("run")]

    def rows():
        return store.read_rows(out / f"{name}.csv")

    write()
    return SimpleNamespace(name=name, file=file, out=out, write=write, run=run, ran=ran, rows=rows)


def test_run_writes_rows_page_and_figure(tiny, capsys):
    assert tiny.run() == 0
    row = tiny.rows()["name=plain,x=1.5"]
    assert row["square"] == "2.25" and row["status"] == "ok" and row["note"] == ""
    assert float(row["wall_s"]) >= 0 and float(row["cpu_s"]) >= 0 and float(row["peak_mib"]) >= 0
    assert row["code"] and row["when"] and row["machine"] and row["threads"] and "numpy" in row["versions"]
    # A warm process: the rows' own environment, not that of the tests.
    assert (row["layer"], row["spin"]) == ("workqueue", "PASSIVE")
    page = (tiny.out / f"{tiny.name}.md").read_text()
    assert page.startswith("# A tiny study.\n\nText below") and "| ok  | squares are small " in page
    assert (tiny.out / f"{tiny.name}.png").read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr().out
    assert page in printed and f"{tiny.name}.png" in printed and "[2/2]" in printed
    assert sorted(p.name for p in tiny.out.iterdir()) == [f"{tiny.name}.{end}" for end in ("csv", "md", "png")]


def test_warm_up_comes_first_and_in_the_same_process(tiny, tmp_path):
    tiny.ran()
    assert (tmp_path / "log").read_text().split("\n")[:4] == ["warm plain", "run plain", "warm second", "run second"]


def test_rows_are_reused_until_forced(tiny):
    assert tiny.ran() == ["plain", "second"]
    before = tiny.rows()
    assert tiny.ran() == [] and tiny.rows() == before
    assert tiny.ran(force=True) == ["plain", "second"]


def test_quick_is_a_subset_and_full_adds_the_rest(tiny):
    assert tiny.ran(quick=True) == ["plain"]
    assert tiny.ran() == ["second"]
    assert tiny.ran(quick=True) == [] and len(tiny.rows()) == 2


def test_only_what_a_row_runs_invalidates_it(tiny):
    tiny.ran()
    tiny.write(**{"A tiny study": "A renamed study", "axes.plot": "axes.semilogy", "def _log": "# why\ndef _log"})
    assert tiny.ran() == []
    tiny.write(**{"x * x": "x * x + 0"})
    assert len(tiny.ran()) == 2
    tiny.write(**{"x * x": "x * x + 0", '"warm "': '"warmer "'})
    assert len(tiny.ran()) == 2


@pytest.mark.parametrize("column", provenance.SAME)
def test_other_code_machine_threads_or_versions_invalidate(tiny, column):
    tiny.ran()
    path = tiny.out / f"{tiny.name}.csv"
    rows = list(tiny.rows().values())
    rows[0][column] = "another"
    store.write_rows(path, rows)
    assert tiny.ran() == ["plain"]


MOVED = """
from studies.harness import methods
CASES = [{"x": 1.5, "method": "toy"}]
QUICK = bool

def run(x, method):
    return {"square": methods.load(method).solve(x)}
"""


def test_a_renamed_module_loses_no_row(tmp_path, monkeypatch):
    """The method is a file with a helper; then a folder whose solver and helper have other names and places."""
    home, name = tmp_path / f"home_{tmp_path.name}", f"moved_{tmp_path.name}"
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    monkeypatch.setattr(provenance, "PACKAGES", (home.name,))
    monkeypatch.setattr(methods, "HOMES", (home.name,))
    monkeypatch.setattr(runner, "triad_gbs", lambda: 12.5)
    solve, helper = "def solve(x):\n    return square(x)\n", "def square(x):\n    return x * x\n"

    def rows(**files):
        shutil.rmtree(home, ignore_errors=True)
        for path, text in {"__init__": "", **files}.items():
            (home / f"{path}.py").parent.mkdir(parents=True, exist_ok=True)
            (home / f"{path}.py").write_text(text)
        for cached in (provenance.code_hash, provenance._parse, importlib.invalidate_caches):
            getattr(cached, "cache_clear", cached)()
        for module in [each for each in sys.modules if each.startswith((home.name, name))]:
            del sys.modules[module]
        runner.run_study(name, tmp_path, say=lambda line: None, compute=lambda *a: made.append(1) or computed(*a))
        return store.read_rows(tmp_path / f"{name}.csv"), len(made)

    def computed(_, study, case):
        return runner.compute_row(study, case, warm=False)

    made = []
    (tmp_path / f"{name}.py").write_text(MOVED)
    before = rows(toy=f"from {home.name}.helper import square\n{solve}", helper=helper)
    assert before[1] == 1 and before[0]["x=1.5,method=toy"]["square"] == "2.25"
    files = {"toy/__init__": f"from {home.name}.toy.core import solve\n", "toy/deep/power": helper}
    moved = files | {"toy/core": f"from {home.name}.toy.deep.power import square\n{solve}"}
    assert rows(**moved) == before
    # The check can fail: other code is another row.
    other = moved | {"toy/deep/power": helper.replace("x * x", "x**2")}
    assert rows(**other)[1] == 2


def test_bad_rows_do_not_stop_the_run(tiny, capsys):
    bad = ("refuses", "raises", "dies", "sleeps")
    tiny.write(", ".join(f'{{"name": "{name}", "x": {k}.0}}' for k, name in enumerate(bad, start=3)))
    status = tiny.run()
    rows = {row["name"]: row for row in tiny.rows().values()}
    assert [rows[n]["status"] for n in ("plain", "second")] == ["ok", "ok"]
    assert [rows[n]["status"] for n in bad] == ["unsupported", "failed", "failed", "timeout"]
    assert rows["refuses"]["note"] == "not for x = 3"
    assert rows["raises"]["note"] == "RuntimeError in run: no convergence after 7 iterations"
    assert "SIGABRT" in rows["dies"]["note"] and "1.5 s" in rows["sleeps"]["note"]
    assert all(row["code"] for row in rows.values())
    assert status == 1 and "FAIL: Rows that failed or ran out of time: 3" in capsys.readouterr().err
    # Failed rows are tried again, refusals are not.
    assert tiny.ran() == ["raises", "dies", "sleeps"]


def test_a_refusal_fails_no_claim(tiny):
    tiny.write('{"name": "refuses", "x": 3.0}')
    assert tiny.run() == 0


@pytest.mark.parametrize("limit", [3, ">= 5", "= 0", ">= nan"])
def test_a_failed_claim_gives_a_failing_status(tiny, limit, capsys):
    tiny.write(limit=limit)
    assert tiny.run() == 1
    assert "FAIL: squares are small" in capsys.readouterr().err
    assert "| FAIL | squares are small" in (tiny.out / f"{tiny.name}.md").read_text()


@pytest.mark.parametrize("broken", ["df['square'].max()", "df['nothing']"])
def test_what_cannot_be_judged_or_drawn_fails(tiny, broken, capsys):
    if broken == "df['nothing']":
        tiny.write(**{'df["square"].max()': broken})
    else:
        tiny.write(**{'axes.plot(df["x"]': 'axes.plot(df["nothing"]'})
    assert tiny.run() == 1
    assert "KeyError" in capsys.readouterr().err


def test_a_killed_run_resumes(tiny):
    tiny.write(", ".join(f'{{"name": "slow", "x": {k}.0}}' for k in range(3, 7)))
    words = [sys.executable, "-m", "studies", "run", tiny.name, "--out", str(tiny.out)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env={**os.environ, "COLUMNS": "80"})
    for line in process.stdout:
        if line.startswith("[3/"):
            break
    time.sleep(0.15)  # in the middle of row 4
    process.send_signal(signal.SIGKILL)
    process.communicate()
    stored = tiny.rows()
    assert len(stored) >= 3 and all(row["status"] == "ok" for row in stored.values())
    runs = tiny.ran()
    assert len(runs) == 6 - len(stored) and len(tiny.rows()) == 6
    assert {key: tiny.rows()[key] for key in stored} == stored


def test_a_row_dies_with_its_run(tiny, tmp_path):
    tiny.write('{"name": "sleeps", "x": 3.0}', **{"time.sleep(60)": "_log(f'pid {os.getpid()}'); time.sleep(60)"})
    words = [sys.executable, "-m", "studies", "row", tiny.name, "2", "--json", str(tmp_path / "row.json"), "--parent"]
    code = f"import os, subprocess, time; subprocess.Popen([*{words!r}, str(os.getpid())]); time.sleep(60)"
    parent = subprocess.Popen([sys.executable, "-c", code])
    pid = _wait_for(lambda: _logged_pid(tmp_path / "log"))
    parent.kill()
    parent.wait()
    assert _wait_for(lambda: not _alive(pid))


def test_a_row_whose_run_is_gone_computes_nothing(tiny, tmp_path):
    words = [sys.executable, "-m", "studies", "row", tiny.name, "0", "--json", str(tmp_path / "row.json")]
    assert subprocess.run([*words, "--parent", str(2**30)]).returncode == 1  # no process has this number
    assert not (tmp_path / "row.json").exists() and not (tmp_path / "log").exists()


def _wait_for(condition, seconds=20):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"did not happen in {seconds} s")


def _logged_pid(log):
    words = log.read_text().split("pid ") if log.exists() else []
    return int(words[1]) if len(words) > 1 else None


def _alive(pid):
    try:
        state = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state not in "ZX"


def test_row_prints_one_row_and_finds_it_by_number_or_key(tiny, capsys):
    assert main(["row", tiny.name, "1"]) == 0
    assert "square               4.0" in capsys.readouterr().out
    assert main(["row", tiny.name, "name=plain,x=1.5"]) == 0
    assert main(["row", tiny.name, "name=none"]) == 2
    assert "no case 'name=none'" in capsys.readouterr().err


def test_render_needs_the_csv_alone(tiny, capsys):
    assert main(["render", tiny.name, "--out", str(tiny.out)]) == 2
    tiny.run()
    pages = [tiny.out / f"{tiny.name}.{end}" for end in ("md", "png")]
    before = pages[0].read_text()
    for page in pages:
        page.unlink()
    (tiny.file.parent / "log").unlink()
    assert main(["render", tiny.name, "--out", str(tiny.out)]) == 0
    assert pages[0].read_text() == before and pages[1].exists() and not (tiny.file.parent / "log").exists()


def test_unknown_study_and_equal_cases_are_refused(tiny, capsys):
    assert main(["run", tiny.name, "no_such_study"]) == 2
    assert "no study 'no_such_study'" in capsys.readouterr().err and not tiny.out.exists()
    tiny.write('{"name": "plain", "x": 1.5}')
    assert main(["run", tiny.name]) == 2


def test_parameters_called_as_columns_of_every_row_are_refused(tiny, capsys):
    tiny.write('{"name": "third", "load": 1.0}')
    assert main(["run", tiny.name]) == 2
    assert "parameters ['load']" in capsys.readouterr().err and not tiny.out.exists()


def test_metrics_must_not_replace_parameters(tiny):
    tiny.write(**{'"square": x * x': '"square": x * x, "x": 0.0'})
    assert tiny.run() == 1
    assert "parameters of its case" in tiny.rows()["name=plain,x=1.5"]["note"]


def test_list_names_every_study(capsys):
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in study_names())


def test_csv_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "rows.csv"
    store.write_rows(path, [{"case": "a", "value": 0.1 + 0.2, "note": 'comma, "quote"\nand line'}])
    assert store.read_rows(path)["a"] == {"case": "a", "value": repr(0.1 + 0.2), "note": 'comma, "quote"\nand line'}
    before = path.read_bytes()
    with path.open("rb") as reader:  # a reader at this moment still sees the old file, whole
        store.write_rows(path, [{"case": "b"}])
        assert reader.read() == before and list(store.read_rows(path)) == ["b"]
    before = path.read_bytes()
    with pytest.raises(ZeroDivisionError), store.replaced(path) as temporary:
        temporary.write_text("half a fi")
        raise ZeroDivisionError
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_columns_come_in_order(tmp_path):
    path = tmp_path / "rows.csv"
    store.write_rows(path, [{"case": "a", "x": 1, "status": "ok", "y": 2}, {"case": "b", "wall_s": 1.0, "z": 3}])
    with path.open() as file:
        assert next(csv.reader(file)) == ["case", "x", "y", "z", "wall_s", "status"]


def test_peak_memory_is_of_the_call_alone():
    if not cost._reset_peak():
        pytest.skip("this system cannot reset a process's peak memory")
    before = np.ones(40_000_000)
    del before
    doubles = 16_000_000
    _, spent = cost.measured(lambda: float(np.ones(doubles).sum()))
    # 122 MiB asked for; the kernel counts pages in batches per processor: some MiB of slack both ways.
    assert spent["peak_mib"] == pytest.approx(doubles * 8 / cost.MIB, abs=16)
    assert spent["peak_by"] == "VmHWM"
    assert cost.measured(lambda: None)[1]["peak_mib"] < 16


def test_processor_seconds_count_this_process_and_its_children():
    def spin(seconds=0.2):
        end = time.process_time() + seconds
        while time.process_time() < end:
            pass

    value, spent = cost.measured(lambda: spin() or "done")
    assert value == "done" and spent["cpu_s"] >= 0.2
    code = "import time\nwhile time.process_time() < 0.2: pass"
    _, spent = cost.measured(subprocess.run, [sys.executable, "-c", code], check=True)
    assert spent["cpu_s"] >= 0.2


def test_peak_memory_without_the_kernels_help(monkeypatch):
    monkeypatch.setattr(cost, "_reset_peak", lambda: False)
    _, spent = cost.measured(lambda: None)
    assert spent["peak_by"] == "ru_maxrss" and spent["peak_mib"] >= 0


def test_triad_is_a_memory_bandwidth():
    # Below any machine's that runs this, above any cache's: a wrong unit or count of bytes falls out.
    assert 0.5 < cost.triad_gbs(elements=2_000_000, repeats=2) < 3000


def test_claims():
    assert table.claim("a", 0.06, 0.06).ok and not table.claim("a", 0.061, 0.06).ok
    assert table.claim("a", 1.7, ">= 1.7").ok and not table.claim("a", 1.69, ">= 1.7").ok
    assert table.claim("a", 0, "= 0").ok and not table.claim("a", float("nan"), "<= 1").ok
    with pytest.raises(ValueError, match="limit = 'about 3'"):
        table.claim("a", 3, "about 3")


def test_markdown():
    df = pd.DataFrame({"method": ["a|b", "c"], "error": [0.123456, float("nan")], "unknowns": [123456.0, 7.0]})
    assert table.markdown(df).split("\n") == [
        "| method | error | unknowns |",
        "|--------|------:|---------:|",
        "| a\\|b   | 0.123 |   123456 |",
        "| c      |       |        7 |",
    ]
