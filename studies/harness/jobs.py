"""Rows as plain commands for a batch system, and home again."""

import json
import shlex
import sys
from pathlib import Path

from studies.harness import runner
from studies.harness.provenance import ANYWHERE
from studies.harness.store import add_rows, case_key, check_writable, read_rows


def commands(name, out, *, quick=False, force=False):
    """A command for each row that is still to be made; it leaves its row in a file of its own."""
    study = runner.load(name)
    path = runner.csv_of(name, out)
    folder = path.with_name(f"{path.stem}-rows").absolute()
    _, todo = runner.still_to_run(study, path, quick=quick, force=force, same=ANYWHERE)
    numbers = {case_key(case): number for number, case in enumerate(study.CASES)}
    if todo:
        check_writable(folder)
    return [_command(name, key, folder / f"{numbers[key]:05}.json") for key in map(case_key, todo)]


def _command(name, key, file):
    return shlex.join([sys.executable, "-m", "studies", "row", name, key, "--json", str(file)])


def gather(name, out, files):
    """Add rows from files to those of a study; a row that failed takes the place of none that did not."""
    study = runner.load(name)
    keys, path = [case_key(case) for case in study.CASES], runner.csv_of(name, out)
    stored, found = read_rows(path), {}
    for file in files:
        row = _row_in(file, keys)
        older = found.get(row["case"], stored.get(row["case"]))
        if older is None or row["status"] in runner.KEPT or older["status"] not in runner.KEPT:
            found[row["case"]] = row
    if found:
        add_rows(path, found, keys)
    return path, len(found)


def _row_in(file, keys):
    try:
        row = json.loads(Path(file).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{file}: must hold a row that `row --json` wrote: {error}") from None
    if not isinstance(row, dict) or "status" not in row or row.get("case") not in keys:
        raise ValueError(f"{file}: must hold a row of this study")
    return row
