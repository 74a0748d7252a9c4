"""The command line of the studies, on a study small enough to break on purpose."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.__main__ import PATIENCE, main, study_names

ROOT = Path(__file__).parents[3]


def test_run_writes_rows_page_and_figure(tiny, capsys):
    assert tiny.run() == 0
    row = tiny.rows()["name=plain,x=1.5"]
    assert row["square"] == "2.25" and row["status"] == "ok" and row["note"] == ""
    assert float(row["wall_s"]) >= 0 and float(row["cpu_s"]) >= 0 and float(row["peak_mib"]) >= 0
    assert row["commit"] and row["when"] and row["machine"] and row["threads"] and "numpy" in row["versions"]
    # A warm process: the rows' own environment, not that of the tests.
    assert (row["layer"], row["spin"]) == ("workqueue", "PASSIVE")
    page = (tiny.out / f"{tiny.name}.md").read_text()
    assert page.startswith("# A tiny study.\n\nText below") and "| ok  | squares are small " in page
    assert (tiny.out / f"{tiny.name}.png").read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr().out
    assert page in printed and f"{tiny.name}.png" in printed and "[2/2]" in printed
    assert sorted(p.name for p in tiny.out.iterdir()) == [f"{tiny.name}.{end}" for end in ("csv", "md", "png", "svg")]


def test_row_prints_one_row_and_finds_it_by_number_or_key(tiny, capsys):
    assert main(["row", tiny.name, "1"]) == 0
    assert "square               4.0" in capsys.readouterr().out
    assert main(["row", tiny.name, "name=plain,x=1.5"]) == 0
    assert main(["row", tiny.name, "name=none"]) == 2
    assert "no case 'name=none'" in capsys.readouterr().err
    assert main(["row", tiny.name, "9" * 5000]) == 2
    assert "no case '999" in capsys.readouterr().err


def test_render_needs_the_csv_alone(tiny, capsys):
    assert main(["render", tiny.name, "--out", str(tiny.out)]) == 2
    tiny.made()
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


@pytest.mark.parametrize(
    ("words", "seconds"), [([], PATIENCE), (["--quick"], 0), (["--quick", "--wait", "5"], 5), (["--wait", "0"], 0)]
)
def test_only_costs_that_are_kept_are_waited_for(words, seconds, tiny, monkeypatch):
    asked = []

    def stopped(compute, *, seconds, say):
        asked.append(seconds)
        raise ValueError("no further")

    monkeypatch.setattr("studies.harness.quiet.quietly", stopped)
    assert main(["run", tiny.name, "--out", str(tiny.out), *words]) == 2
    assert asked == [seconds]


def test_list_names_every_study(capsys):
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in study_names())


def test_list_says_what_is_stored(tiny, capsys, monkeypatch):
    tiny.made(quick=True)
    monkeypatch.setattr("studies.__main__.study_names", lambda: [tiny.name])
    assert main(["list", "--out", str(tiny.out)]) == 0
    assert "2 rows,   1 quick,    1 stored   A tiny study." in capsys.readouterr().out


def test_ctrl_c_ends_a_run_with_a_line_and_no_process_left(tiny, tmp_path):
    tiny.write(
        '{"name": "sleeps", "x": 3.0}',
        **{'_log("run " + name)': '_log(f"run {name} {os.getpid()}")'},
    )
    run = subprocess.Popen(
        [sys.executable, "-m", "studies", "run", tiny.name, "--out", str(tiny.out), "--wait", "0"],
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(tmp_path)])},
        text=True,
        # Where SIGINT is ignored, as in the background of a script, children would ignore it too.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    log = tmp_path / "log"
    while not (log.exists() and "run sleeps" in log.read_text()):
        assert run.poll() is None
        time.sleep(0.05)
    run.send_signal(signal.SIGINT)
    # The row would sleep for a minute.
    _, said = run.communicate(timeout=30)
    assert run.returncode == 130
    assert said == "\nstudies: interrupted: rows done are kept; the same command goes on\n"
    assert sorted(row["status"] for row in tiny.rows().values()) == ["ok", "ok"]
    with pytest.raises(ProcessLookupError):
        os.kill(int(log.read_text().split()[-1]), 0)
