"""One case in a fresh process of a worker: its cost is its own, a crash is an error like others, a limit ends it."""

import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from demheat.beyond.cluster import completed, row_environment
from demheat.runtime import fresh
from demheat.sweeps.rows import failed, row_of


def on_workers(client, function: Callable, cases: Sequence[dict], limit: float | None) -> Iterator[tuple[int, dict]]:
    """Rows of cases, as they are done."""
    import cloudpickle

    tasks = [(cloudpickle.dumps((function, case)), limit) for case in cases]
    for number, found in completed(client, in_fresh_process, tasks, label=getattr(function, "__name__", "sweep")):
        case = cases[number]
        if isinstance(found, Exception):
            yield number, failed(case, f"{type(found).__name__}: {found}")
        elif "lost" in found:
            yield number, failed(case, found["lost"])
        else:
            yield number, {**case, **found}


def in_fresh_process(sent: bytes, limit: float | None) -> dict:
    """The row of a case, or {"lost": why there is none}."""
    with tempfile.NamedTemporaryFile() as question:
        question.write(sent)
        question.flush()
        words = [sys.executable, "-m", __name__, question.name, str(os.getpid())]
        try:
            return fresh.answer_of(words, limit=limit, start=partial(fresh.run, environment=row_environment()))
        except TimeoutError as error:
            return {"lost": f"TimeoutError: {error}"}
        except ChildProcessError as error:
            return {"lost": str(error)}


def main(question: str, parent: str, answer: str) -> None:
    """Compute the case of one file into another."""
    fresh.die_with_parent(int(parent))
    import cloudpickle

    function, case = cloudpickle.loads(Path(question).read_bytes())
    row = row_of(function, case)
    Path(answer).write_text(json.dumps({name: value for name, value in row.items() if name not in case}))


if __name__ == "__main__":
    main(*sys.argv[1:])
