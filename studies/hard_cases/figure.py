"""Outcomes by method and by family as bars, and every error beside what is right."""

import numpy as np

from studies.hard_cases.means import title, verdicts
from studies.harness.figures import GREEN, GREY, ORANGE, RED

COLOURS = {"verified": GREEN, "refused": GREY, "warned": ORANGE, "wrong": RED}
WORDS = {
    "verified": "right",
    "refused": "refused, with its reason",
    "warned": "off, and says so",
    "wrong": "silently wrong",
}
# Below this an error is drawn as this, in units of what is right.
FLOOR = 1e-4
# And above this as this: of a conductivity that should be nearly none an error has no size.
CEILING = 1e6


def plot(df):
    """Outcomes by method and family, and the errors of what is verified or warned of."""
    from matplotlib import pyplot

    each = verdicts(df)
    each = each[each["outcome"].isin(COLOURS)].assign(name=each["method"].str.split(",").str[0].map(title))
    figure, axes = pyplot.subplots(1, 3, figsize=(13, 5), width_ratios=(1, 1, 1.15))
    _bars(axes[0], each, "name", "methods")
    _bars(axes[1], each, "family", "hardness")
    _errors(axes[2], each)
    right, wrong = (int((each["outcome"] == name).sum()) for name in ("verified", "wrong"))
    words = f"{len(each)} hard cases: {right} right to 2 % or within their own interval, {wrong} silently wrong"
    figure.suptitle(words, x=0.01, ha="left")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _bars(axes, each, column, words):
    names = list(dict.fromkeys(each[column]))[::-1]
    left = np.zeros(len(names))
    for outcome, colour in COLOURS.items():
        counts = np.array([((each[column] == name) & (each["outcome"] == outcome)).sum() for name in names])
        axes.barh(names, counts, left=left, color=colour, label=WORDS[outcome])
        left += counts
    axes.set(title=f"by {words}", xlabel="cases")
    axes.grid(False, axis="y")


def _errors(axes, each):
    """Sorted errors of each method, over what is right: which part of its answers is how good."""
    answers = each[each["error"].notna()]
    names = list(dict.fromkeys(answers["name"]))[::-1]
    for place, name in enumerate(names):
        rows = answers[answers["name"] == name]
        size = np.clip((rows["error"].abs() / rows["allowed"]).to_numpy(), FLOOR, CEILING)
        spread = place + 0.6 * (np.arange(len(rows)) % 9 - 4) / 9
        axes.scatter(size, spread, s=9, c=[COLOURS[outcome] for outcome in rows["outcome"]], linewidths=0)
    axes.axvline(1.0, color="black", linewidth=1)
    axes.set(xscale="log", yticks=range(len(names)), title="each answer")
    axes.set_xlabel("|error| over what is right, cut at 1e-4 and 1e6")
    axes.set_yticklabels(names)
    axes.grid(False, axis="y")
