"""Families by methods."""

import pandas as pd

from studies.hard_cases.means import title, verdicts

SHOWN = ("verified", "refused", "warned", "wrong")


def table(df):
    """Who holds where: cases of each family by method, right / refused / warned / silently wrong.

    Those whose certain bounds are too wide to judge by are left out; a scene that refuses itself has no method.
    """
    each = verdicts(df)
    each["method"] = each["method"].str.split(",").str[0].map(title)
    families, names = (list(dict.fromkeys(each[column])) for column in ("family", "method"))
    found = []
    for family in [*families, "all"]:
        rows = each if family == "all" else each[each["family"] == family]
        cells = {name: counted(rows[rows["method"] == name]["outcome"]) for name in names}
        found.append({"family": family, **cells, "all": counted(rows["outcome"])})
    return pd.DataFrame(found)


def counted(outcomes) -> str:
    """Verified / refused / warned / wrong; empty without any."""
    return " / ".join(str(int((outcomes == name).sum())) for name in SHOWN) if len(outcomes) else ""
