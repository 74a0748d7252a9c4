"""Tables and sentences of studies inside other Markdown pages: what stands between two marks comes from a CSV.

A mark names a study, and a function of it: one that makes rows to print, without a name `table`, or one that says what
came out in words, without a name `words`.
"""

import re
from pathlib import Path

from demheat.runtime.paths import replaced
from studies.harness import runner
from studies.harness.table import markdown, read_frame

MARKED = re.compile(r"(<!-- (table|words) (\w+)(?: (\w+))? -->).*?(<!-- end of \2 -->)", re.DOTALL)


def filled(text, folder):
    """Page with each marked table and sentence written anew from folder/NAME.csv."""

    def anew(match):
        begin, kind, name, function, end = match.groups()
        path = Path(folder) / f"{name}.csv"
        if not path.exists():
            raise ValueError(f"no {path}; run the study first")
        study, function = runner.load(name), function or kind
        if not hasattr(study, function):
            raise ValueError(f"{begin}: the study has no function {function}")
        made = getattr(study, function)(read_frame(study, path))
        return begin + (made if kind == "words" else f"\n\n{markdown(made)}\n\n") + end

    return MARKED.sub(anew, text)


def fill(page, folder):
    """Write what is marked in a page anew."""
    page = Path(page)
    text = filled(page.read_text(encoding="utf-8"), folder)
    with replaced(page) as temporary:
        temporary.write_text(text, encoding="utf-8")
