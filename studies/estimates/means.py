"""Figures read off the rows of estimates."""

import pandas as pd

from studies.common.drawn import ACCURACY
from studies.harness.methods import all_methods


def present(df, name):
    """Whether a method has answered any scene."""
    return f"{name}_off" in df and df[f"{name}_off"].notna().any()


# Errors, %, that are as good as none: what is said over them is endless.
NOTHING = 1e-5


def answered(df, name):
    """Rows of scenes with a conductivity that the method has answered."""
    return df[df[f"{name}_off"].notna() & (df["exact"] > 0)]


def inside(df, name, what=""):
    """Whether the true error is no larger than what the method says, for each scene."""
    rows = answered(df, name)
    # Beside parts that no element sees nothing is said of the temperature: nothing to judge.
    rows = rows[rows[f"{name}_{what}half"].notna()]
    # What the reference itself may be off counts for neither.
    return rows[f"{name}_{what}off"].abs() <= rows[f"{name}_{what}half"] + 100 * ACCURACY


def over(df, name, what=""):
    """What the method says over its error, for each scene where there is one."""
    rows = answered(df, name)
    rows = rows[rows[f"{name}_{what}off"].abs() > NOTHING]
    return rows[f"{name}_{what}half"] / rows[f"{name}_{what}off"].abs()


def lines(df, names):
    """One line of each method."""
    return pd.DataFrame([_line(df, name) for name in names if present(df, name)])


def intervals_in_words(df, names):
    """How many exact conductivities lie inside, and how wide the intervals are, as a part of a sentence."""
    names = [name for name in names if present(df, name)]
    held = [f"{inside(df, name).sum()} of {len(inside(df, name))} ({all_methods()[name].title})" for name in names]
    wide = [f"{over(df, name).median():.2g}" for name in names]
    return (
        f"{', '.join(held)}; half of it was {', '.join(wide)} times the error in the median of errors beyond "
        f"{NOTHING:g} %"
    )


def answers_in_words(asked, accuracy):
    """What `effective` got right, as a sentence."""
    answered = asked[asked["worst_percent"].notna()]
    right, held = (answered["worst_percent"] <= 100 * accuracy).sum(), answered["inside"].eq(True).sum()
    return (
        f"Of {len(asked)} scenes `effective` had {right} right to {100 * accuracy:g} %, {held} with all entries inside "
        f"of their intervals."
    )


def _line(df, name):
    rows = answered(df, name)
    line = {"scenes": f"{len(rows)} unseen", "method": all_methods()[name].title}
    for what, words in (("", "k"), ("t_", "T")):
        line |= {
            f"error of {words}, median %": rows[f"{name}_{what}off"].abs().median(),
            f"said of {words}, median %": rows[f"{name}_{what}half"].median(),
            f"{words} inside": f"{100 * inside(df, name, what).mean():.1f} %",
            f"{words}, said over error": over(df, name, what).median(),
        }
    return line | {"cost over solve": (rows[f"{name}_more_s"] / rows[f"{name}_cpu_s"]).median()}
