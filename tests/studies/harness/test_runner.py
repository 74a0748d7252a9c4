"""Rows are run, reused and resumed, on a study small enough to break on purpose."""

import csv
import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.__main__ import main
from studies.harness import provenance, runner, store


def test_warm_up_comes_first_and_in_the_same_process(tiny, tmp_path):
    tiny.ran()
    assert (tmp_path / "log").read_text().split("\n")[:4] == ["warm plain", "run plain", "warm second", "run second"]


def test_rows_are_reused_until_forced(tiny):
    assert tiny.made() == ["plain", "second"]
    before = tiny.rows()
    assert tiny.made() == [] and tiny.rows() == before
    assert tiny.made(force=True) == ["plain", "second"]


def test_quick_is_a_subset_and_full_adds_the_rest(tiny):
    assert tiny.made(quick=True) == ["plain"]
    assert tiny.made() == ["second"]
    assert tiny.made(quick=True) == [] and len(tiny.rows()) == 2


def test_a_row_that_this_code_has_made_again_holds(tiny):
    """Whatever commit has measured its costs; a row whose values alone were made anew holds by these."""
    tiny.made()
    path, here = tiny.out / f"{tiny.name}.csv", next(iter(tiny.rows().values()))["commit"]
    old = [row | {"commit": "1"} for row in tiny.rows().values()]
    for columns in (("replayed_commit", "values_commit"), ("borne_commit", "borne_commit")):
        store.write_rows(path, [row | {column: here} for row, column in zip(old, columns, strict=True)])
        assert tiny.made() == []
    store.write_rows(path, [old[0] | {"replayed_commit": "2"}, old[1] | {"values_commit": "2"}])
    assert tiny.made() == ["plain", "second"]


def test_a_row_for_its_values_alone_is_what_the_study_makes_again(tiny, monkeypatch):
    """A search goes by costs: what of it does not is `again`; a row with costs is made by `run`."""
    for variable in ("NUMBA_THREADING_LAYER", "OMP_WAIT_POLICY"):
        monkeypatch.setenv(variable, "")
    again = "def again(name, x):\n    return {'square': x * x + 1}\n\ndef claims(df):"
    tiny.write(**{"def claims(df):": again})
    study = runner.load(tiny.name)
    row = runner.compute_row(study, study.CASES[0], warm=False)
    assert (row["square"], "layer" in row) == (3.25, False)
    row = runner.compute_row(study, study.CASES[0])
    assert (row["square"], "layer" in row) == (2.25, True)


@pytest.mark.parametrize("column", provenance.SAME)
def test_another_machine_threads_or_versions_invalidate(tiny, column):
    tiny.made()
    path = tiny.out / f"{tiny.name}.csv"
    rows = list(tiny.rows().values())
    rows[0][column] = "another"
    store.write_rows(path, rows)
    assert tiny.made() == ["plain"]


def test_bad_rows_do_not_stop_the_run(tiny, capsys):
    bad = ("refuses", "raises", "dies", "sleeps")
    cases = ", ".join(f'{{"name": "{name}", "x": {k}.0}}' for k, name in enumerate(bad, start=3))
    # On a busy machine processes alone take seconds to start.
    tiny.write(cases, **{"TIMEOUT = 60.0": "TIMEOUT = 8.0"})
    status = tiny.run()
    rows = {row["name"]: row for row in tiny.rows().values()}
    assert [rows[n]["status"] for n in ("plain", "second")] == ["ok", "ok"]
    assert [rows[n]["status"] for n in bad] == ["unsupported", "failed", "failed", "timeout"]
    assert rows["refuses"]["note"] == "not for x = 3"
    assert rows["raises"]["note"] == "RuntimeError in run: no convergence after 7 iterations"
    assert "SIGABRT" in rows["dies"]["note"] and "8 s" in rows["sleeps"]["note"]
    assert all(row["commit"] for row in rows.values())
    assert status == 1 and "FAIL: Rows that failed or ran out of time: 3" in capsys.readouterr().err
    # Failed rows are tried again, refusals are not.
    again = []
    tiny.ran(compute=lambda name, study, case: again.append(case["name"]) or rows[case["name"]])
    assert again == ["raises", "dies", "sleeps"]


def test_a_killed_run_resumes(tiny):
    tiny.write(", ".join(f'{{"name": "slow", "x": {k}.0}}' for k in range(3, 7)))
    words = [sys.executable, "-m", "studies", "run", tiny.name, "--out", str(tiny.out), "--wait", "0"]
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
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state not in "ZX"


def test_metrics_must_not_replace_parameters(tiny):
    tiny.write(**{'"square": x * x': '"square": x * x, "x": 0.0'})
    with pytest.raises(ValueError, match="parameters of its case"):
        tiny.made()


@pytest.mark.parametrize("value", ["x", "None"])
def test_metrics_may_repeat_parameters_or_leave_them_open(tiny, value):
    tiny.write(**{'"square": x * x': f'"square": x * x, "x": {value}'})
    tiny.made()
    row = tiny.rows()["name=plain,x=1.5"]
    assert row["status"] == "ok" and float(row["x"]) == 1.5


def test_two_runs_on_one_folder_lose_no_row(tiny):
    """While one computes its row another run makes both: the first one must not write its older view."""

    def compute(name, study, case):
        if not inner:
            inner.append(True)
            runner.run_study(name, tiny.out, force=True, say=lambda line: None, compute=compute)
        return runner.compute_row(study, case, warm=False)

    inner = []
    runner.run_study(tiny.name, tiny.out, quick=True, say=lambda line: None, compute=compute)
    assert [row["name"] for row in tiny.rows().values()] == ["plain", "second"]


def test_a_folder_that_cannot_be_written_is_found_before_the_first_row(tiny, tmp_path, capsys, monkeypatch):
    def ran(*words):
        status = main(["run", tiny.name, *words])
        return status, capsys.readouterr().err, (tmp_path / "log").exists()

    (tmp_path / "file").write_text("")
    status, said, begun = ran("--out", str(tmp_path / "file"))
    assert status == 2 and "must be a folder that can be written" in said and said.count("\n") == 1 and not begun

    def full(*args, **knobs):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(store.tempfile, "TemporaryFile", full)
    status, said, begun = ran("--out", str(tiny.out))
    assert status == 2 and "No space left on device" in said and not begun


@pytest.mark.parametrize("name", ["../x", "", ".", "x y", "/tmp/x", "a..b"])
def test_a_name_that_is_none_is_refused_in_a_line(name, capsys):
    assert main(["run", name]) == 2
    assert capsys.readouterr().err.startswith(f"studies: no study {name!r}; must be a name")


def test_broken_results_are_named(tiny, capsys):
    tiny.out.mkdir()
    path = tiny.out / f"{tiny.name}.csv"
    for make in (lambda: path.write_text("no rows"), lambda: (path.unlink(), path.mkdir())):
        make()
        for words in (["run", tiny.name], ["render", tiny.name]):
            assert main([*words, "--out", str(tiny.out)]) == 2
            said = capsys.readouterr().err
            assert f"{path}: must hold rows of a study as CSV" in said and said.count("\n") == 1
    path.rmdir()
    path.write_text("case,status\na,ok\n")
    assert main(["render", tiny.name, "--out", str(tiny.out)]) == 2
    assert "lacks the columns ['note', " in capsys.readouterr().err


def test_a_disk_that_fills_up_while_rows_are_written(tiny, capsys, monkeypatch):
    """The rows done stay, the new one is kept elsewhere, a line says where; with room again the run goes on."""
    for name in ("NUMBA_THREADING_LAYER", "OMP_WAIT_POLICY"):
        monkeypatch.setenv(name, "")
    monkeypatch.setattr(runner, "spawn_row", lambda name, *row, **knobs: runner.compute_row(*row, warm=False))
    tiny.run("--quick")
    before, writes = tiny.rows(), []
    capsys.readouterr()

    class Full(csv.DictWriter):
        def writerows(self, rows):
            writes.append(1)
            if len(writes) == 1:
                raise OSError(errno.ENOSPC, "No space left on device")
            super().writerows(rows)

    with monkeypatch.context() as patch:
        patch.setattr(csv, "DictWriter", Full)
        assert tiny.run() == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "No space left on device" in said and "; the rows are in " in said
    assert tiny.rows() == before and len(list(tiny.out.iterdir())) == 4
    assert list(store.read_rows(said.rpartition(" ")[2].strip())) == ["name=plain,x=1.5", "name=second,x=2.0"]
    assert tiny.run() == 0 and len(tiny.rows()) == 2
