"""Tables of studies inside other Markdown pages: what stands between two marks comes from a CSV.

A mark names a study, and a function of it that makes rows to print; without one it is `table`.
"""

from __future__ import annotations

import re
from pathlib import Path

from studies.harness import runner
from studies.harness.store import replaced
from studies.harness.table import markdown, read_frame

MARKED = re.compile(r"(<!-- table (\w+)(?: (\w+))? -->\n).*?(<!-- end of table -->)", re.DOTALL)


def filled(text, folder):
    """Page with each marked table written anew from folder/NAME.csv.

    Parameters
    ----------
    text : str
        Of a page in Markdown.
    folder : path
        Of the studies' results.

    Returns
    -------
    str

    Raises
    ------
    ValueError
        If a marked study has no rows in the folder, or no such function.
    """

    def table(match):
        path = Path(folder) / f"{match[2]}.csv"
        if not path.exists():
            raise ValueError(f"no {path}; run the study first")
        study, name = runner.load(match[2]), match[3] or "table"
        if not hasattr(study, name):
            raise ValueError(f"<!-- table {match[2]} {name} -->: the study has no function {name}")
        made = getattr(study, name)(read_frame(study, path))
        return f"{match[1]}\n{markdown(made)}\n\n{match[4]}"

    return MARKED.sub(table, text)


def fill(page, folder):
    """Write the marked tables of a page anew.

    Parameters
    ----------
    page : path
    folder : path
        Of the studies' results.
    """
    page = Path(page)
    text = filled(page.read_text(encoding="utf-8"), folder)
    with replaced(page) as temporary:
        temporary.write_text(text, encoding="utf-8")
