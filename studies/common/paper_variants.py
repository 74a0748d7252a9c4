"""What rows of the paper's network say: values and errors of each variant, with intervals, and which is the best."""

from typing import NamedTuple

import numpy as np

from demheat import referee
from studies.common.paper_network import HELD, NAME, PACKINGS, calibrations
from studies.harness.pick import Interval, pick, student
from studies.harness.table import markdown

PACKED = {"lsa": "LSA", "relaxed": "relaxed"}
ACTING = {"center": "held at centres", "surface": "held at the wall", "periodic": "no walls"}
BY = {"flux": "C_t by flux", "isothermal": "C_t isothermally", "cell": "C_t in the cell"}


class Variant(NamedTuple):
    """One way of the paper's network."""

    packing: str
    held: str
    calibration: str

    @property
    def words(self):
        """The variant in words."""
        return f"{PACKED[self.packing]} packing, {ACTING[self.held]}, {BY[self.calibration]}"


def parted(df):
    """Rows of the network in its variants, and all others."""
    ours = df["name"] == NAME if "name" in df else np.zeros(len(df), dtype=bool)
    return df[ours & (df["status"] == "ok")] if "status" in df else df[ours], df[~ours]


def variants(held=HELD, packings=PACKINGS):
    """All variants there are under some kinds of walls."""
    return [Variant(p, walls, way) for p in packings for walls in held for way in calibrations(walls)]


def values(network, variant, column):
    """A column in proportion to C_t, calibrated, of each packing of one variant."""
    rows = pick(network, packing=variant.packing, held=variant.held)
    if column not in rows or f"ct_{variant.calibration}" not in rows:
        return np.empty(0)
    found = (rows[column] * rows[f"ct_{variant.calibration}"]).to_numpy(dtype=float)
    return found[~np.isnan(found)]


def interval(found):
    """Mean and interval of values of packings, see `pick.student`; without it of one; None of none."""
    if len(found) == 1:
        return Interval(float(found[0]), np.nan, np.nan, 1)
    return student(found) if len(found) else None


def variant_errors(network, exact, *, column="k_{}"):
    """Errors of all variants, %, by number of particles."""
    made = {}
    for number in sorted(network["particles"].unique()) if len(network) else ():
        rows = network[network["particles"] == number]
        for variant in variants():
            found = {}
            for name, value in exact.items():
                here = interval(100 * referee.value_error(values(rows, variant, column.format(name)), value))
                found |= {name: here} if here else {}
            if found:
                made[variant, int(number)] = found
    return made


def worst_error(found, among=None):
    """Largest |mean error| of one variant."""
    return max(abs(each.mean) for name, each in found.items() if among is None or name in among)


def best_variant(made, among=None):
    """The variant whose largest |mean error| is least at the largest number of particles that all have."""
    counts = {number: sum(other == number for _, other in made) for _, number in made}
    full = [number for number, count in counts.items() if count == max(counts.values())]
    ranked = [key for key in made if key[1] == max(full)] if full else []
    return min(ranked, key=lambda key: worst_error(made[key], among)) if ranked else None


def told_of(made, among=None, measure="error", unit="%"):
    """A sentence on the best and the worst variant, made of rows; empty without any."""
    first = best_variant(made, among)
    if first is None:
        return ""
    rank = sorted((worst_error(found, among), key) for key, found in made.items() if key[1] == first[1])
    least, most = rank[0], rank[-1]
    packings = {each.number for key, found in made.items() if key[1] == first[1] for each in found.values()}
    count = f"{min(packings)}" if len(packings) == 1 else f"{min(packings)} to {max(packings)}"
    over = "one packing each" if packings == {1} else f"means over {count} packings"
    return (
        f"Of {len(rank)} variants of the paper's network with {first[1]} particles ({over}) the "
        f"best is: {least[1][0].words}, largest {measure} {least[0]:.2g} {unit}; the worst: {most[1][0].words}, "
        f"{most[0]:.2g} {unit}."
    )


def cell(each):
    """Mean and half the width of its interval as text, as "-0.90 +- 0.05"."""
    if each is None:
        return ""
    return f"{each.mean:+.2f}" + ("" if np.isnan(each.half) else f" +- {each.half:.2f}")


def lines_of(made, names, among=None):
    """Lines of a table, one for each variant and number of particles."""
    first, rows = best_variant(made, among), []
    for (variant, number), found in made.items():
        row = {"packing": PACKED[variant.packing], "temperatures": ACTING[variant.held]}
        row |= {"C_t": BY[variant.calibration].removeprefix("C_t "), "particles": number}
        row |= {title: cell(found.get(name)) for name, title in names.items()}
        row["packings"] = max(each.number for each in found.values())
        rows.append(row | {"": "best" if (variant, number) == first else ""})
    return rows


def shown(made, names, what, best="", among=None):
    """A sentence on what a table of all variants shows, and the table; nothing without any."""
    import pandas as pd

    said = f"The paper's network {what}, means over packings with their 95 % intervals (Student's){best}."
    return [said, markdown(pd.DataFrame(lines_of(made, names, among)))] if made else []
