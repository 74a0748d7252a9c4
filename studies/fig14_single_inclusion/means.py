"""What is printed of the sphere in a cube, and what is exact of it."""

from studies.fig14_single_inclusion.scenes import SCENES, label
from studies.harness.pick import pick
from studies.harness.printed import printed

PAPER = printed("fig14_single_inclusion")


def exact_of(df, name="exact"):
    """k over the matrix's by a method without resolution, by the labels of the network's scenes."""
    found = {label(*where): pick(df, name=name, scene=where[0], contrast=where[1])["k_ratio"] for where in SCENES}
    return {where: float(values.iloc[0]) for where, values in found.items() if len(values)}
