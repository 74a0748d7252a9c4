"""Command line of the studies: list, run, render, row, report."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import studies
from studies.harness import runner
from studies.harness.provenance import row_environment
from studies.harness.store import read_rows

DEFAULT_OUT, STORED = Path("out"), Path("results")
# As a shell says of a command that SIGINT ended.
INTERRUPTED = 130


def main(words=None):
    """Do what the command line says and return the exit status: 0 only if no claim failed, 130 if interrupted."""
    arguments = _parser().parse_args(words)
    for stream in (sys.stdout, sys.stderr):
        # A page may hold a letter that a terminal of another alphabet has not: that must not cost the run.
        getattr(stream, "reconfigure", lambda **knobs: None)(errors="backslashreplace")
    try:
        return arguments.action(arguments)
    except (ValueError, OSError) as error:
        print(f"studies: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        kept = ": rows done are kept; the same command goes on" if arguments.action is _run else ""
        print(f"\nstudies: interrupted{kept}", file=sys.stderr)
        return INTERRUPTED


def _parser():
    parser = argparse.ArgumentParser(prog="python -m studies", description=__doc__)
    actions = parser.add_subparsers(required=True, metavar="list | run | render | row | report")
    names = actions.add_parser("list", help="name the studies, and say whether stored rows are those of this code")
    names.set_defaults(action=_list)
    run = actions.add_parser("run", help="bring studies up to date (all, if none is named) and judge their claims")
    run.add_argument("names", nargs="*", metavar="NAME")
    run.add_argument("--quick", action="store_true", help="only the quick rows")
    run.add_argument("--force", action="store_true", help="repeat rows that could be reused")
    run.add_argument("--method", metavar="MODULE|PROGRAM", help="rows of a method that is not ours, beside those there")
    run.set_defaults(action=_run)
    render = actions.add_parser("render", help="write table, claims and figure again from the CSV")
    render.add_argument("names", nargs=1, metavar="NAME")
    render.set_defaults(action=_render)
    row = actions.add_parser("row", help="compute one row here and print it")
    row.add_argument("name", metavar="NAME")
    row.add_argument("case", metavar="CASE", help="key as in the column 'case', or number in CASES")
    row.add_argument("--json", metavar="FILE", help=argparse.SUPPRESS)
    row.add_argument("--parent", type=int, help=argparse.SUPPRESS)
    row.set_defaults(action=_row)
    report = actions.add_parser("report", help="write DIR/README.md, the pages of all studies found there")
    words = "also write the tables marked in these pages anew"
    report.add_argument("--page", metavar="FILE", type=Path, nargs="+", default=[], help=words)
    report.set_defaults(action=_report)
    for each in (names, run, render, report):
        where = STORED if each is names and STORED.is_dir() else DEFAULT_OUT
        each.add_argument("--out", default=where, metavar="DIR", type=Path, help=f"default {where}")
    return parser


def study_names():
    """Names of all studies: the modules of this package that have CASES."""
    home = Path(studies.__path__[0])
    files = {path.stem: path for path in home.glob("*.py")}
    files |= {path.parent.name: path for path in home.glob("*/__init__.py")}
    return sorted(name for name, path in files.items() if "CASES" in path.read_text(encoding="utf-8").split())


def _list(arguments):
    for name in study_names():
        study = runner.load(name)
        quick = sum(bool(study.QUICK(case)) for case in study.CASES)
        rows = runner.state(study, read_rows(arguments.out / f"{name}.csv"))
        # Without docstrings (python -OO) the name must do.
        title = (study.__doc__ or name).strip().splitlines()[0]
        stored = ", ".join(f"{count:3} {word}" for word, count in rows.items())
        print(f"{name:24} {len(study.CASES):4} rows, {quick:3} quick; {stored}   {title}")
    print(f"Rows stored in {arguments.out}: held, made by this code; stale, by other code; missing, not made.")
    return 0


def _run(arguments):
    chosen = arguments.names or study_names()
    for name in chosen:
        runner.load(name)  # a misspelt name must not cost the studies before it
    status, knobs = 0, {"quick": arguments.quick, "force": arguments.force, "say": _say}
    if arguments.method is not None:
        if len(chosen) > 1:
            raise ValueError(f"--method {arguments.method}: must be of one study, as `run sphere_benchmark`")
        knobs["method"] = arguments.method
        runner.guests_of(chosen[0], arguments.method)  # a misspelt one must leave nothing behind
        _beside_stored(chosen[0], arguments.out)
    for name in chosen:
        path = runner.run_study(name, arguments.out, **knobs)
        status |= _show(name, path)
    return status


def _beside_stored(name, out):
    """Rows that a study's new ones are to stand beside: the stored ones, where there are none yet."""
    stored, path = STORED / f"{name}.csv", out / f"{name}.csv"
    if stored.exists() and not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(stored.read_bytes())
        print(f"{path}: begun with the rows of {stored}")


def _render(arguments):
    name = arguments.names[0]
    runner.load(name)
    path = arguments.out / f"{name}.csv"
    if not path.exists():
        raise ValueError(f"no {path}; run the study first")
    return _show(name, path)


def _show(name, path):
    """Render a study, print its page and say where the figure is; 1 if a claim failed."""
    from studies.harness.table import render

    claims, text = render(runner.load(name), path)
    print(text)
    failed = [claim for claim in claims if not claim.ok]
    print(f"{name}: {len(claims) - len(failed)} of {len(claims)} claims hold")
    print(f"figure {path.with_suffix('.png')}, rows {path}")
    for claim in failed:
        print(f"FAIL: {claim.sentence}: {claim.value:.4g}, limit {claim.limit}", file=sys.stderr)
    return 1 if failed else 0


def _row(arguments):
    # Before any library that reads these is loaded.
    os.environ.update(row_environment())
    if arguments.parent:
        runner.die_with_parent(arguments.parent)
    study = runner.load(arguments.name)
    row = runner.compute_row(study, runner.find_case(study, arguments.case))
    if arguments.json:
        runner.write_json(row, arguments.json)
        return 0
    for name, value in row.items():
        print(f"{name:20} {value}")
    return 0 if row["status"] in runner.KEPT else 1


def _report(arguments):
    from studies.harness.readme import fill
    from studies.harness.store import replaced
    from studies.harness.table import render

    status, pages = 0, []
    for name in study_names():
        path = arguments.out / f"{name}.csv"
        if path.exists():
            claims, text = render(runner.load(name), path)
            pages.append(text)
            status |= any(not claim.ok for claim in claims)
    if not pages:
        raise ValueError(f"no results in {arguments.out}; run a study first")
    target = arguments.out / "README.md"
    with replaced(target) as temporary:
        temporary.write_text("\n".join(pages), encoding="utf-8")
    for page in arguments.page:
        fill(page, arguments.out)
    print(f"{len(pages)} studies in {target}; " + ("a claim FAILED" if status else "every claim holds"))
    return int(status)


def _say(line):
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main())
