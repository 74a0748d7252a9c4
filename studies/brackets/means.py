"""Figures read off the rows of brackets."""

from __future__ import annotations

import numpy as np

from studies.harness.pick import order


def narrowest(rows, *, cpu_s=np.inf):
    """Least width of rows that cost at most so much, %; None if there is none.

    Parameters
    ----------
    rows : DataFrame
    cpu_s : float, s
    """
    rows = rows[rows["cpu_s"] <= cpu_s]
    return None if rows.empty else rows["width_percent"].min()


def order_of_width(rows):
    """Order with which the width falls with the edge of elements; None without two rows.

    Parameters
    ----------
    rows : DataFrame
    """
    if len(rows) < 2:
        return None
    # Meshes follow spheres besides the size that is asked for: their number of elements says how fine they are.
    return order(rows["elements"].to_numpy(float) ** (-1 / 3), rows["width_percent"].to_numpy())


def place(rows):
    """Where between lower (0) and upper bound (1) the exact value is.

    Parameters
    ----------
    rows : DataFrame
    """
    return (rows["exact"] - rows["lower"]) / (rows["upper"] - rows["lower"])
