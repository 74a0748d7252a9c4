"""Tables of studies inside another Markdown page: what stands between two marks comes from a CSV."""

from __future__ import annotations

import re
from pathlib import Path

from studies.harness import runner
from studies.harness.store import replaced
from studies.harness.table import markdown, read_frame

MARKED = re.compile(r"(<!-- table (\w+) -->\n).*?(<!-- end of table -->)", re.DOTALL)


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
        If a marked study has no rows in the folder.
    """

    def table(match):
        path = Path(folder) / f"{match[2]}.csv"
        if not path.exists():
            raise ValueError(f"no {path}; run the study first")
        study = runner.load(match[2])
        return f"{match[1]}\n{markdown(study.table(read_frame(study, path)))}\n\n{match[3]}"

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
