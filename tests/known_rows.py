"""Rows of methods whose values are chosen."""

import pandas as pd


def ladder(name, knob, sizes, values, **where):
    return pd.DataFrame({"name": name, knob: sizes, "k_ratio": values, "status": "ok", **where})
