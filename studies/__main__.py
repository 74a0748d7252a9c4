"""Command line of the studies: list, run, render, row, jobs, gather, replay, accept, check, report."""

import argparse
import os
import sys
from contextlib import ExitStack
from pathlib import Path

import studies
from demheat.runtime import fresh
from demheat.terminal.ends import BAD, INTERRUPTED, error_line, finished, of_output
from studies import contents
from studies.harness import jobs, lasting, quiet, replay, runner, sound
from studies.harness.cluster import spreading
from studies.harness.forked import forking, serve
from studies.harness.machines import origins
from studies.harness.provenance import row_environment
from studies.harness.store import read_rows

DEFAULT_OUT, STORED = Path("out"), Path("results")
# Processes on one machine: more is a slip.
MOST_WORKERS = 1024
# Seconds that a run waits in all for others to leave the machine to it; a clean run is given hours, a quick one, whose
# costs nobody keeps, none.
PATIENCE = 60
# Rows with one fault that `check` names; all of them on demand.
NAMED = 3


def main(words=None):
    """Do what the command line says and return the exit status: 0 only if no claim failed, 130 if interrupted."""
    for stream in (sys.stdout, sys.stderr):
        # A page may hold a letter that a terminal of another alphabet has not: that must not cost the run.
        getattr(stream, "reconfigure", lambda **knobs: None)(errors="backslashreplace")
    return finished(lambda: _done(words), "studies")


def _done(words):
    arguments = _parser().parse_args(words)
    try:
        return arguments.action(arguments)
    except (ValueError, OSError) as error:
        if of_output(error):
            raise
        print(f"studies: {error_line(error)}", file=sys.stderr)
        return BAD
    except KeyboardInterrupt:
        kept = ": rows done are kept; the same command goes on" if arguments.action is _run else ""
        print(f"\nstudies: interrupted{kept}", file=sys.stderr)
        return INTERRUPTED


def _parser():
    parser = argparse.ArgumentParser(prog="python -m studies", description=__doc__)
    actions = parser.add_subparsers(required=True, metavar="list | run | render | row | ... | report")
    names = actions.add_parser("list", help="name the studies, their rows, and how many are stored")
    names.set_defaults(action=_list)
    run = actions.add_parser("run", help="bring studies up to date (all, if none is named) and judge their claims")
    run.add_argument("names", nargs="*", metavar="NAME")
    run.add_argument("--quick", action="store_true", help="only the quick rows")
    again = run.add_mutually_exclusive_group()
    again.add_argument("--force", action="store_true", help="repeat rows that could be reused")
    words = "also repeat rows that were made on uncommitted changes or in noise, see `check`"
    again.add_argument("--clean", dest="force", action="store_const", const="unsound", help=words)
    words = f"wait so long, in all, for a quiet machine, so that costs count; default {PATIENCE}, with --quick 0"
    run.add_argument("--wait", metavar="SECONDS", type=_seconds, help=words)
    run.add_argument("--method", metavar="MODULE|PROGRAM", help="rows of a method that is not ours, beside those there")
    where = run.add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="ADDRESS", help="make rows on the Dask cluster of tcp://HOST:PORT")
    where.add_argument("--workers", metavar="N", type=_number, help="make rows in N processes side by side, by Dask")
    run.set_defaults(action=_run)
    render = actions.add_parser("render", help="write table, claims and figure again from the CSV")
    render.add_argument("names", nargs=1, metavar="NAME")
    render.set_defaults(action=_render)
    row = actions.add_parser("row", help="compute one row here; print it or keep it in a file")
    row.add_argument("name", metavar="NAME")
    row.add_argument("case", metavar="CASE", help="key as in the column 'case', or number in CASES")
    row.add_argument("--json", metavar="FILE", help="write the row there, in JSON, for `gather`")
    row.add_argument("--values", action="store_true", help="once, without a warm-up: its costs mean nothing then")
    row.add_argument("--parent", type=int, help=argparse.SUPPRESS)
    row.set_defaults(action=_row)
    first = actions.add_parser("first")  # of which rows are copies
    first.add_argument("parent", type=int)
    first.set_defaults(action=_first)
    array = actions.add_parser("jobs", help="print a command for each row still to be made, for a batch system")
    array.add_argument("name", metavar="NAME")
    array.add_argument("--quick", action="store_true", help="only the quick rows")
    array.add_argument("--force", action="store_true", help="also rows that could be reused")
    array.set_defaults(action=_jobs)
    gather = actions.add_parser("gather", help="add the rows that such commands left in files")
    gather.add_argument("name", metavar="NAME")
    gather.add_argument("files", metavar="FILE", nargs="+")
    gather.set_defaults(action=_gather)
    words = "make stored rows again, two side by side, and compare what they hold; exit status 1 if a value has moved"
    again = actions.add_parser("replay", help=words)
    again.add_argument("names", nargs="*", metavar="NAME")
    again.add_argument("--all", action="store_true", help="not the quick rows alone")
    again.add_argument("--old", action="store_true", help="only rows that this code has neither made nor made again")
    again.set_defaults(action=_replay)
    words = "make rows again that a change of code has moved, and print old and new side by side; costs stay"
    accepted = actions.add_parser("accept", help=words)
    accepted.add_argument("names", nargs="*", metavar="NAME")
    accepted.set_defaults(action=_accept)
    words = "say of which commits rows are, when they were last replayed, which are missing, dirty or noisy"
    check = actions.add_parser("check", help=f"{words}; exit status 1 if any is missing")
    check.add_argument("names", nargs="*", metavar="NAME")
    check.add_argument("--rows", action="store_true", help="name every one of them")
    words = "exit status 1 also for a row that this code has neither made nor replayed, or whose cost does not count"
    check.add_argument("--release", action="store_true", help=words)
    check.set_defaults(action=_check)
    words = "write the pages of all studies found in DIR, DIR/README.md and, in one, DIR/index.html"
    report = actions.add_parser("report", help=words)
    words = "also write the tables marked in these pages anew"
    report.add_argument("--page", metavar="FILE", type=Path, nargs="+", default=[], help=words)
    report.set_defaults(action=_report)
    for each in (names, run, render, array, gather, again, accepted, check, report):
        where = STORED if each in (names, again, accepted, check) and STORED.is_dir() else DEFAULT_OUT
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
        kept = read_rows(arguments.out / f"{name}.csv")
        stored = len(study.CASES) - len(replay.lacking(study, arguments.out / f"{name}.csv"))
        machines = len(set(origins(kept.values())))
        # Without docstrings (python -OO) the name must do.
        title = (study.__doc__ or name).strip().splitlines()[0]
        more = f"; {machines} machines" if machines > 1 else ""
        print(f"{name:24} {len(study.CASES):4} rows, {quick:3} quick, {stored:4} stored{more}   {title}")
    print(f"Rows stored in {arguments.out}; `python -m studies check` says of which code they are.")
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
    patience = (0 if arguments.quick else PATIENCE) if arguments.wait is None else arguments.wait
    with ExitStack() as stack:
        spread = stack.enter_context(spreading(arguments.scheduler, arguments.workers, _say))
        # Rows that are measured side by side would wait for each other.
        alone = quiet.quietly(stack.enter_context(forking()), seconds=patience, say=_say)
        alone.beside = stack.enter_context(replay.side_by_side())
        knobs |= {"compute": alone, "spread": spread}
        for number, name in enumerate(chosen):
            if not (spread or arguments.method) and arguments.force is not True:
                replay.bear_out({name: runner.load(name)}, arguments.out, quick=arguments.quick, say=_say)
            if len(chosen) > 1:
                _say(f"study {number + 1} of {len(chosen)}: {_to_run(chosen[number:], arguments)} left")
            status |= _show(name, runner.run_study(name, arguments.out, **knobs))
    return status


def _to_run(names, arguments):
    """How many rows of some studies a run would make, and how long they take by those that are stored, in words."""
    found = []
    for name in names:
        study, path = runner.load(name), runner.csv_of(name, arguments.out)
        todo = runner.still_to_run(study, path, quick=arguments.quick, force=arguments.force)[1]
        known = path if path.exists() else runner.csv_of(name, STORED)
        found += lasting.seconds(study, known, todo).values()
    return lasting.time_in_words(found)


def _beside_stored(name, out):
    """Rows that a study's new ones are to stand beside: the stored ones, where there are none yet."""
    stored, path = STORED / f"{name}.csv", out / f"{name}.csv"
    if stored.exists() and not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(stored.read_bytes())
        print(f"{path}: begun with the rows of {stored}")


def _number(word):
    if not word.isdecimal() or not 1 <= int(word) <= MOST_WORKERS:
        raise argparse.ArgumentTypeError(f"{word!r}: must be a whole number from 1 to {MOST_WORKERS}")
    return int(word)


def _seconds(word):
    try:
        found = float(word)
    except ValueError:
        found = -1.0
    if not 0 <= found < float("inf"):
        raise argparse.ArgumentTypeError(f"{word!r}: must be a number of seconds, 0 or more")
    return found


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
    failed, open_ = [claim for claim in claims if claim.failed], sum(bool(claim.why) for claim in claims)
    rest = f", {open_} not judged" if open_ else ""
    print(f"{name}: {sum(claim.ok and not claim.why for claim in claims)} of {len(claims)} claims hold{rest}")
    print(f"figure {path.with_suffix('.png')}, rows {path}")
    for claim in failed:
        print(f"FAIL: {claim.sentence}: {claim.value:.4g}, limit {claim.limit}", file=sys.stderr)
    return 1 if failed else 0


def _row(arguments):
    # Before any library that reads these is loaded.
    os.environ.update(row_environment())
    if arguments.parent:
        fresh.die_with_parent(arguments.parent)
    study = runner.load(arguments.name)
    case = runner.find_case(study, arguments.case)
    if arguments.json and not arguments.parent:
        # For itself alone: with a time limit, and a row whatever happens.
        row = runner.spawn_row(arguments.name, study, case, values=arguments.values)
        runner.write_json(row, arguments.json)
        return 0 if row["status"] in runner.KEPT else 1
    row = runner.compute_row(study, case, warm=not arguments.values)
    if arguments.json:
        runner.write_json(row, arguments.json)
        return 0
    for name, value in row.items():
        print(f"{name:20} {value}")
    return 0 if row["status"] in runner.KEPT else 1


def _first(arguments):
    serve(main, arguments.parent)
    return 0


def _jobs(arguments):
    for command in jobs.commands(arguments.name, arguments.out, quick=arguments.quick, force=arguments.force):
        print(command)
    return 0


def _gather(arguments):
    path, count = jobs.gather(arguments.name, arguments.out, arguments.files)
    print(f"{arguments.name}: {count} rows added to {path}")
    return 0


def _replay(arguments):
    tasks = []
    for name, study, path in _stored(arguments):
        cases = replay.stored_cases(study, path, quick=not arguments.all, unproved=arguments.old)
        tasks += [(name, study, case) for case in cases]
    wrong = [each for _, found, _ in replay.replayed(tasks, arguments.out, _say) for each in found]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    rows = len({(each.study, each.case) for each in wrong})
    print(f"{arguments.out}: {len(tasks)} rows made again, {rows} of them with values that moved")
    return int(bool(wrong))


def _accept(arguments):
    from studies.harness.accept import accept

    touched, failed = accept([name for name, *_ in _stored(arguments)], arguments.out, _say)
    for name in touched:
        _show(name, runner.csv_of(name, arguments.out))
    if touched:
        print(f"pages that show them: python -m studies report --out {arguments.out} --page README.md docs/*.md")
    print(*(f"not made again: {line}" for line in failed), sep="\n", end="\n" if failed else "")
    return int(bool(failed))


def _check(arguments):
    every, absent, old = [], 0, 0
    for name, study, path in _stored(arguments):
        found, rows, gone = sound.checked(study, path), read_rows(path), replay.lacking(study, path)
        every += found.values()
        absent += len(gone)
        unproved = [key for key in found if not sound.proved(study, rows[key])]
        old += len(unproved)
        print(
            f"{name:24} {len(found):4} rows: {sound.in_words(sound.counted(found.values()))}; "
            f"{sound.ages(rows.values())}"
        )
        _name_some("missing", gone, arguments.rows)
        if arguments.release:
            _name_some("of other code, not replayed", unproved, arguments.rows)
        for wrong in dict.fromkeys(filter(None, found.values())):
            _name_some(", ".join(wrong), [key for key, each in found.items() if each == wrong], arguments.rows)
    full = [
        each for name, study, path in _stored(arguments) for each in lasting.seconds(study, path, study.CASES).values()
    ]
    print(f"made anew by two processors that nobody else uses: {lasting.time_in_words(full)}")
    print(
        f"{arguments.out}: {len(every)} rows: {absent} missing, {old} of other code and not replayed by this one, "
        + sound.in_words(sound.counted(every))
    )
    return int(bool(absent) or arguments.release and (old > 0 or any(every)))


def _stored(arguments):
    """Name, study and file of the studies that are named, or of all that have rows; of one at least."""
    found = []
    for name in arguments.names or study_names():
        study, path = runner.load(name), runner.csv_of(name, arguments.out)
        if path.exists():
            found.append((name, study, path))
        elif arguments.names:
            raise ValueError(f"no {path}; run the study first")
    if not found:
        raise ValueError(
            f"--out {arguments.out}: must be a folder with rows of a study, as {runner.csv_of('NAME', arguments.out)}"
        )
    return found


def _name_some(word, keys, every):
    shown = len(keys) if every else NAMED
    more = [f"and {len(keys) - shown} more"] if len(keys) > shown else []
    print(*(f"    {word}: {key}" for key in [*keys[:shown], *more]), sep="\n", end="\n" if keys else "")


def _report(arguments):
    from studies.harness import report
    from studies.harness.readme import fill

    found = report.chapters(study_names(), arguments.out)
    paths = report.write(found, arguments.out, contents)
    for page in arguments.page:
        fill(page, arguments.out)
    claims = [claim for each in found for claim in each.claims]
    status = any(claim.failed for claim in claims) or any(each.problem for each in found)
    for each in found:
        if each.problem:
            print(each.problem, file=sys.stderr)
    print(f"{len(found)} studies in {' and '.join(map(str, paths))}; {sound.total(found)}")
    verdict = "a claim FAILED" if any(claim.failed for claim in claims) else "no claim failed"
    print(f"{len(claims)} claims: {verdict}, {sum(bool(claim.why) for claim in claims)} not judged")
    return int(status)


def _say(line):
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main())
