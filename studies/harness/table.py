"""From a study's CSV alone: its table and claims in Markdown, its figure."""

from __future__ import annotations

import math
import re
import traceback
from pathlib import Path
from typing import NamedTuple

from studies.harness.machines import of_one_machine, said
from studies.harness.runner import guest_case
from studies.harness.store import case_key, read_rows, replaced

OPERATORS = {"<=": float.__le__, "<": float.__lt__, ">=": float.__ge__, ">": float.__gt__, "=": float.__eq__}
# What every row has.
NEEDED = ("case", "status", "note", "code", "commit", "when", "machine", "threads", "versions", "load")


class Claim(NamedTuple):
    """A sentence with the value that decides it; `limit` is "<= 0.06", ">= 1.7" and the like."""

    sentence: str
    value: float
    limit: str
    ok: bool


def render(study, csv_path):
    """Write NAME.md and NAME.png beside NAME.csv and return (claims, text of the Markdown file).

    What cannot be judged or drawn is a claim that failed, with the reason as its sentence.

    Parameters
    ----------
    study : module
    csv_path : path

    Returns
    -------
    claims : list of Claim
    text : str
    """
    csv_path = Path(csv_path)
    df = read_frame(study, csv_path)
    claims = judged(study, df)
    figure = csv_path.with_suffix(".png")
    try:
        _draw(study, df, figure)
    except Exception as error:
        traceback.print_exc()
        figure.unlink(missing_ok=True)
        claims.append(Claim(f"the figure can be drawn ({type(error).__name__}: {error})", math.nan, "= 1", False))
    try:
        text = _page(study, df, claims, figure)
    except Exception as error:
        traceback.print_exc()
        claims.append(Claim(f"the table can be made ({type(error).__name__}: {error})", math.nan, "= 1", False))
        text = _page(_Plain(study), df, claims, figure)
    with replaced(csv_path.with_suffix(".md")) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return claims, text


class _Plain:
    """A study without its table and notes, which rows that are few or odd may not make."""

    def __init__(self, study):
        self.CASES, self.__doc__, self.__name__ = study.CASES, study.__doc__, study.__name__


def read_frame(study, csv_path):
    """Rows of the study's present cases as a data frame.

    Parameters
    ----------
    study : module
    csv_path : path

    Returns
    -------
    data frame

    Raises
    ------
    ValueError
        If the file does not hold rows of a study.
    """
    import pandas as pd

    rows = read_rows(csv_path)
    lacking = [name for name in NEEDED if any(name not in row for row in rows.values())]
    if lacking or not rows:
        raise ValueError(f"{csv_path}: {f'lacks the columns {lacking}' if lacking else 'has no rows'}; run the study")
    df = pd.read_csv(csv_path, dtype={"case": str, "note": str, "code": str})
    ours = df["case"].isin([case_key(case) for case in study.CASES])
    guests = df["case"].map(lambda key: guest_case(study, key) is not None)
    return of_one_machine(df[ours | guests].reset_index(drop=True).fillna({"note": ""}))


def judged(study, df):
    """Claims of a study on its rows; first, that none failed.

    Parameters
    ----------
    study : module
    df : data frame
        Of `read_frame`.

    Returns
    -------
    list of Claim
    """
    bad = df[df["status"].isin(("failed", "timeout"))]
    claims = [claim("Rows that failed or ran out of time", float(len(bad)), "= 0")]
    try:
        claims += [claim(*each) for each in study.claims(df)]
    except Exception as error:
        traceback.print_exc()
        claims.append(Claim(f"the claims can be judged ({type(error).__name__}: {error})", math.nan, "= 1", False))
    return claims


def claim(sentence, value, limit):
    """Judge a value by a limit: a number (at most), or text such as ">= 1.7"; not-a-number never holds.

    Parameters
    ----------
    sentence : str
    value : float
    limit : float or str

    Returns
    -------
    Claim
    """
    limit = f"<= {limit:g}" if isinstance(limit, int | float) else limit
    match = re.fullmatch(r"(<=|>=|<|>|=)\s*(\S+)", limit)
    if match is None:
        raise ValueError(f"limit = {limit!r}: must be a number or such as '<= 0.06', '>= 1.7', '= 0'")
    value = float(value)
    return Claim(sentence, value, limit, OPERATORS[match[1]](value, float(match[2])))


def markdown(df):
    """Data frame as an aligned Markdown table, numbers to three significant digits, large ones whole."""
    cells = [[str(name) for name in df.columns], *([_cell(v) for v in row] for row in df.itertuples(index=False))]
    widths = [max(3, *(len(row[k]) for row in cells)) for k in range(len(df.columns))]
    numeric = [df.iloc[:, k].map(lambda v: isinstance(v, int | float)).all() for k in range(len(df.columns))]
    lines = [_line(row, widths, numeric) for row in cells]
    rule = "|".join("-" * (w + 1) + (":" if right else "-") for w, right in zip(widths, numeric, strict=True))
    return "\n".join([lines[0], f"|{rule}|", *lines[1:]])


def _line(cells, widths, numeric):
    padded = (c.rjust(w) if right else c.ljust(w) for c, w, right in zip(cells, widths, numeric, strict=True))
    return "| " + " | ".join(padded) + " |"


def _cell(value):
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.0f}" if 1e3 <= abs(value) < 1e7 else f"{value:.3g}"
    return str(value).replace("|", "\\|")


def _draw(study, df, path):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    from studies.harness.figures import STYLE

    with pyplot.rc_context(STYLE):
        figure = study.plot(df)
        with replaced(path) as temporary:
            figure.savefig(temporary)
        pyplot.close(figure)


def _page(study, df, claims, figure):
    import pandas as pd

    title, _, rest = (study.__doc__ or study.__name__).strip().partition("\n")
    judged = pd.DataFrame(
        {
            "": ["ok" if c.ok else "FAIL" for c in claims],
            "claim": [c.sentence for c in claims],
            "value": [f"{c.value:.3g}" for c in claims],
            "limit": [c.limit for c in claims],
        }
    )
    make = getattr(study, "table", _all_rows)
    table, caption = make(df), " ".join((make.__doc__ or "").split())
    return "\n\n".join(
        [
            f"# {title}",
            *([rest.strip()] if rest.strip() else []),
            markdown(table),
            caption,
            *(study.notes(df) if hasattr(study, "notes") else ()),
            f"![{title}]({figure.name})",
            "## Claims",
            markdown(judged),
            "## Where the numbers come from",
            _origin(study, df),
            "",
        ]
    )


def _all_rows(df):
    """Every row."""
    return df.drop(columns=[c for c in ("code", "commit", "when", "machine", "host", "threads", "versions") if c in df])


def _origin(study, df):
    guests = sum(guest_case(study, key) is not None for key in df["case"])
    others = f" and {guests} of methods that are not ours" if guests else ""
    lines = [f"- rows: {len(df) - guests} of {len(study.CASES)} cases{others}; " + _counts(df["status"])]
    for name in ("commit", "machine", "threads", "versions"):
        lines.append(f"- {name}: " + " / ".join(str(v) for v in df[name].dropna().unique()))
    lines.append(f"- made between {df['when'].min()} and {df['when'].max()}")
    lines.append(f"- load average of the machine meanwhile: {df['load'].min():.1f} to {df['load'].max():.1f}")
    if "triad_gbs" in df:
        lines.append(f"- memory bandwidth (triad): {df['triad_gbs'].median():.1f} GB/s")
    if "peak_by" in df and (df["peak_by"] == "ru_maxrss").any():
        lines.append("- peak memory is the whole process's where this system cannot reset it (ru_maxrss)")
    lines += [f"- {sentence}" for sentence in said(df)]
    return "\n".join(lines)


def _counts(status):
    return ", ".join(f"{count} {name}" for name, count in status.value_counts().items())
