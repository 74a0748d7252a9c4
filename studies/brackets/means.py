"""Figures read off the rows of brackets."""

from studies.harness.methods import all_methods
from studies.harness.pick import order


def narrowest(rows):
    """Least width of rows, %; None if there is none."""
    return None if rows.empty else rows["width_percent"].min()


def order_of_width(rows):
    """Order with which the width falls with the edge of elements; None without two rows."""
    if len(rows) < 2:
        return None
    # Meshes follow spheres besides the size that is asked for: their number of elements says how fine they are.
    return order(rows["elements"].to_numpy(float) ** (-1 / 3), rows["width_percent"].to_numpy())


def place(rows):
    """Where between lower (0) and upper bound (1) the exact value is."""
    return (rows["exact"] - rows["lower"]) / (rows["upper"] - rows["lower"])


def narrow(rows, scene):
    """The narrowest bracket of a scene and its cost, as a part of a sentence."""
    least = rows.loc[rows["width_percent"].idxmin()]
    return f"{scene} to {least['width_percent']:.2g} % in {least['cpu_s']:.0f} CPU seconds"


def beside(rows, held):
    """Where answers of methods lie beside a bracket, in its widths, as parts of a sentence."""
    for _, row in rows.iterrows():
        width, title = held["upper"] - held["lower"], all_methods()[row["name"]].title
        if row["k"] > held["upper"]:
            yield f"{title} ({(row['k'] - held['upper']) / width:.2g} of its widths above)"
        elif row["k"] < held["lower"]:
            yield f"{title} ({(held['lower'] - row['k']) / width:.2g} of its widths below)"
        else:
            yield f"{title} (inside)"
