"""From a study's CSV alone: its table and claims in Markdown, its figure."""

import math
import traceback
from pathlib import Path
from types import SimpleNamespace

from demheat.runtime.paths import replaced
from studies.harness import explained
from studies.harness.claims import UNFINISHED, broken, claim, judged, unfinished  # noqa: F401 (known from here, too)
from studies.harness.figures import STYLE, of_claims
from studies.harness.machines import of_one_machine, said
from studies.harness.provenance import guest_case
from studies.harness.sound import cost_columns, counted, faults, in_words, uncosted
from studies.harness.store import VALUES, case_key, read_rows

# What follows on a page is of the rows, not of the code.
ORIGIN = "## Where the numbers come from"
# Columns of words, whatever they look like: a commit may be a number.
WORDS = ("case", "note", "commit", *VALUES)
# Costs that tables may ask for, whatever the rows.
ALWAYS = ("cpu_s", "wall_s", "peak_mib")
# What every row has.
NEEDED = ("case", "status", "note", "commit", "when", "machine", "threads", "versions", "load")


def render(study, csv_path):
    """Write NAME.md, NAME.png and NAME.svg beside NAME.csv and return (claims, text of the Markdown file).

    What cannot be judged or drawn is a claim that failed, with the reason as its sentence; while rows are missing it is
    one that is not judged.
    """
    csv_path = Path(csv_path)
    df = read_frame(study, csv_path)
    claims, why = judged(study, df), UNFINISHED if unfinished(study, df) else ""
    figure = csv_path.with_suffix(".png")
    try:
        _draw(getattr(study, "plot", lambda _: of_claims(claims)), df, figure)
    except Exception as error:
        traceback.print_exc()
        for path in (figure, figure.with_suffix(".svg")):
            path.unlink(missing_ok=True)
        claims.append(broken("the figure can be drawn", error, why=why))
    try:
        text = page(study, df, claims, figure)
    except Exception as error:
        traceback.print_exc()
        claims.append(broken("the table can be made", error, why=why))
        text = page(_plain(study), df, claims, figure)
    with replaced(csv_path.with_suffix(".md")) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return claims, text


def _plain(study):
    """A study without its table and notes, which rows that are few or odd may not make."""
    return SimpleNamespace(**{name: value for name, value in vars(study).items() if name not in ("table", "notes")})


def read_frame(study, csv_path):
    """Rows of the study's present cases as a data frame, without costs where values alone count."""
    import pandas as pd

    rows = read_rows(csv_path)
    lacking = [name for name in NEEDED if any(name not in row for row in rows.values())]
    if lacking or not rows:
        raise ValueError(f"{csv_path}: {f'lacks the columns {lacking}' if lacking else 'has no rows'}; run the study")
    df = pd.read_csv(csv_path, dtype=dict.fromkeys(WORDS, str))
    ours = df["case"].isin([case_key(case) for case in study.CASES])
    guests = df["case"].map(lambda key: guest_case(study, key) is not None)
    # What nobody asks is not there to be used; a study whose rows all count for their values has the columns still.
    df = df.reindex(columns=[*df.columns, *(name for name in ALWAYS if name not in df)])
    costs = cost_columns(study, df)
    df[costs] = df[costs].mask(df["case"].isin(uncosted(study)))
    return of_one_machine(df[ours | guests].reset_index(drop=True).fillna({"note": ""}))


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


def _draw(plot, df, path):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    from studies.harness.pictures import saved

    before = set(pyplot.get_fignums())
    try:
        with pyplot.rc_context(STYLE):
            saved(plot(df), path)
    finally:
        # One that could not be finished, too.
        for number in set(pyplot.get_fignums()) - before:
            pyplot.close(number)


def page(study, df, claims, figure):
    """Text of NAME.md, with a link to the figure if it is there."""
    import pandas as pd

    title, _, rest = (study.__doc__ or study.__name__).strip().partition("\n")
    judged = pd.DataFrame(
        {
            "": [c.verdict for c in claims],
            "claim": [c.sentence for c in claims],
            "value": [f"{c.value:.3g}" for c in claims],
            "limit": [c.limit for c in claims],
        }
    )
    reasons, make = explained.told(study, claims), getattr(study, "table", _all_rows)
    table, caption = make(df), " ".join((make.__doc__ or "").split())
    return "\n\n".join(
        [
            f"# {title}",
            *([rest.strip()] if rest.strip() else []),
            markdown(table),
            caption,
            *(study.notes(df) if hasattr(study, "notes") else ()),
            *_pictured(title, figure),
            "## Claims",
            markdown(judged),
            *_unjudged(claims),
            *(["\n".join(reasons)] if reasons else []),
            ORIGIN,
            _origin(study, df),
            "",
        ]
    )


def _pictured(title, figure):
    if not figure.exists():
        return []
    vector = figure.with_suffix(".svg")
    copy = [f"[The figure as lines and letters]({vector.name})."] if vector.exists() else []
    return [f"![{title}]({figure.name})", *copy]


def _unjudged(claims):
    """Why claims are not judged, a sentence for each reason."""
    reasons = [each.why for each in claims if each.why]
    return [f"Not judged, {why}: {reasons.count(why)} claims." for why in dict.fromkeys(reasons)]


def _all_rows(df):
    """Every row."""
    return df.drop(
        columns=[c for c in ("commit", "when", "machine", "host", "threads", "versions", *VALUES) if c in df]
    )


def _origin(study, df):
    guests = sum(guest_case(study, key) is not None for key in df["case"])
    others = f" and {guests} of methods that are not ours" if guests else ""
    lines = [f"- rows: {len(df) - guests} of {len(study.CASES)} cases{others}; " + _counts(df["status"])]
    count = counted(faults(row) for row in df.to_dict("records"))
    lines.append(f"- rows whose costs do not count: {in_words(count)}")
    for name in ("commit", "machine", "threads", "versions"):
        lines.append(f"- {name}: " + " / ".join(str(v) for v in df[name].dropna().unique()))
    lines.append(f"- made between {df['when'].min()} and {df['when'].max()}")
    for what, words in (
        ("values", "values made anew since, without their costs"),
        ("replayed", "replayed and the same"),
    ):
        again = df[f"{what}_commit"].dropna() if f"{what}_commit" in df else ()
        lines += [f"- {words}: {len(again)} rows, by " + " / ".join(again.unique())] if len(again) else []
    lines.append(f"- load average of the machine meanwhile: {df['load'].min():.1f} to {df['load'].max():.1f}")
    if "noise" in df and df["noise"].notna().any():
        lines.append(f"- share of the processors that others used: at most {df['noise'].max():.1%}")
    if "triad_gbs" in df:
        low, middle, high = (df["triad_gbs"].quantile(q) for q in (0.0, 0.5, 1.0))
        lines.append(f"- memory bandwidth (triad): {middle:.1f} GB/s, {low:.1f} to {high:.1f}")
    if "peak_by" in df and (df["peak_by"] == "ru_maxrss").any():
        lines.append("- peak memory is the whole process's where this system cannot reset it (ru_maxrss)")
    lines += [f"- {sentence}" for sentence in said(df)]
    return "\n".join(lines)


def _counts(status):
    return ", ".join(f"{count} {name}" for name, count in status.value_counts().items())
