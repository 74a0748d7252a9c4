"""Errors of the network's variants."""

from studies.common.paper_variants import parted, variant_errors
from studies.harness.pick import pick


def network_errors(df):
    """Errors of the network's variants against the multipoles' finest."""
    network, others = parted(df)
    spheres = pick(others, name="multipole")
    exact = spheres.loc[spheres["highest"].idxmax(), "k_ratio"]
    return variant_errors(network, {"spheres": float(exact)})
