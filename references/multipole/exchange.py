"""Which way spheres exchange their multipoles: all pairs for few of them, else by cells."""

from references.multipole.fast import PRODUCTS, FastMultipole, plan
from references.multipole.translations import SECONDS, translation

# Seconds of one entry of the periodic sums of one pair, about, on one processor.
ENTRY = 2e-6


def exchange(spheres, order, precision):
    """What makes c of b by `translations.received`."""
    by_cells = plan(spheres, order, precision)
    if direct_seconds(spheres, order) <= by_cells.setup + PRODUCTS * by_cells.product:
        return translation(spheres, 2 * order)
    return FastMultipole(spheres, by_cells)


def direct_seconds(spheres, order) -> float:
    """What all pairs cost, estimated."""
    ordered = spheres.count * len(spheres.radii)
    return ordered * (ENTRY / 2 * (order + 1) * (2 * order + 1) + PRODUCTS * SECONDS * (order + 1) ** 4)
