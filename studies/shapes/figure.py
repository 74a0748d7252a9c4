"""Errors of each shape by each method, and those of fibres against the contrast."""

import numpy as np

from studies.harness.figures import GREY, look
from studies.harness.pick import finest, pick
from studies.shapes.cases import FRACTIONS, PARTS, SINGULAR, SPENT
from studies.shapes.tables import compared

# Nothing is seen below this, %, and shown there.
LEAST = 1e-5


def plot(df):
    """Errors by shape and method; those of fibres against the contrast."""
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(12, 5), width_ratios=(3, 2))
    rows = compared(df)
    _shapes(left, rows)
    _fibres(right, pick(rows, part="fibres"))
    smooth = [_worst(rows, part) for part in ("fibres", *PARTS) if part not in SINGULAR]
    edged = [_worst(rows, part) for part in SINGULAR]
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.suptitle(
        f"At the finer resolution smooth shapes err by {_most(smooth)} % at most, those with edges by {_most(edged)} %"
    )
    return figure


def _most(values):
    values = [value for value in values if np.isfinite(value)]
    return f"{max(values):.2g}" if values else "?"


def _worst(rows, part):
    """Largest error of any method at its finest, %."""
    sizes = [_size(finest(pick(rows, part=part, name=name))) for name in SPENT]
    return np.nanmax([*sizes, -1.0]) if any(np.isfinite(sizes)) else np.nan


def _size(rows):
    errors = rows["error_percent"].abs() if len(rows) else None
    return np.nan if errors is None or errors.isna().all() else max(float(errors.max()), LEAST)


def _shapes(axes, rows):
    parts = ("fibres", *PARTS)
    for shift, name in zip((-0.2, 0.0, 0.2), SPENT, strict=True):
        how = look(name, linestyle="")
        axes.plot([], [], **how)
        for place, part in enumerate(parts):
            mine = pick(rows, part=part, name=name)
            if not len(mine):
                continue
            best = finest(mine)
            both = [_size(mine.drop(best.index)), _size(best)]
            plain = look(name, label="_", linestyle="")
            axes.plot(both, [place + shift] * 2, color=plain["color"], linewidth=0.8, alpha=0.5)
            axes.plot(both[:1], [place + shift], **plain | {"markerfacecolor": "white"})
            axes.plot(both[1:], [place + shift], **plain)
    names = [f"{part}\n(from FEM, no exact value)" if part == "capped rod" else part for part in parts]
    axes.set(xscale="log", yticks=range(len(parts)), yticklabels=names, ylim=(len(parts) - 0.5, -0.5))
    axes.set(xlabel="largest |error of the conductivity|, %", title="Open: coarse, filled: fine")


def _fibres(axes, rows):
    for name in SPENT:
        for fraction, style in zip(FRACTIONS, ("-", "--"), strict=True):
            mine = pick(rows, name=name, fraction=fraction)
            if not len(mine):
                continue
            best = finest(mine).sort_values("contrast")
            how = look(name, linestyle=style)
            axes.plot(best["contrast"], np.maximum(best["error_percent"].abs(), LEAST), **how)
    axes.axvline(1.0, color=GREY, linewidth=0.8)
    axes.set(xscale="log", yscale="log", xlabel="conductivity of the fibres over the matrix's", xlim=(0.005, 200))
    axes.set(ylabel="|error of the conductivity|, %", title="Arrays of fibres, fine (dashed: f = 0.6, alone: 0.3)")
