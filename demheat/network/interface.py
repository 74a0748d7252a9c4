"""Conductances of links, with the rule for links that join two materials."""

import numpy as np

from demheat.network.base import Network

RULES = ("harmonic", "arithmetic")
# Rows connected at once: bounds the scratch memory (some 1.5 kB a row).
BLOCK = 65536


def link_conductivity(k_here, k_there, share, *, rule="harmonic"):
    """Conductivity of links between two materials.

    Parameters
    ----------
    k_here, k_there : (m,) float arrays, W/(m K)
        At the two ends.
    share : (m,) float array
        Part of the link that lies on this side of the facet, 0 to 1; one half gives the papers' harmonic mean
        (Haddad et al. 2021, eq. 24).
    rule : {"harmonic", "arithmetic"}
        Harmonic: the two parts in series, exact where the interface is the facet.

    Returns
    -------
    (m,) float array, W/(m K)
    """
    check_rule(rule)
    share = np.clip(share, 0.0, 1.0)
    if rule == "arithmetic":
        return share * k_here + (1.0 - share) * k_there
    least = np.minimum(k_here, k_there)
    series = share * k_there + (1.0 - share) * k_here
    return np.divide(k_here * k_there, series, out=np.zeros_like(series), where=(least > 0) & (series > 0))


def check_rule(rule):
    """Raise ValueError unless `rule` names an interface rule."""
    if rule not in RULES:
        raise ValueError(f"interface = {rule!r}: must be one of {', '.join(RULES)}")


def connect(facets, centers, size, phase, conductivities, *, rule="harmonic"):
    """Conductances H = k S / d of facets between particles of given phases.

    Parameters
    ----------
    facets : Facets
    centers : (n, 3) float array, m
    size : (3,) float array, m
    phase : (n,) int array
    conductivities : (number of phases,) float array, W/(m K)
    rule : {"harmonic", "arithmetic"}

    Returns
    -------
    Network
        Wall facets conduct k S / h with h the distance from the centre to the wall, exact for linear fields.
    """
    conductivity = conductivities[phase]
    conductance = np.empty(len(facets.indices))
    for start in range(0, len(centers), BLOCK):
        rows = np.arange(start, min(len(centers), start + BLOCK))
        links = slice(facets.indptr[rows[0]], facets.indptr[rows[-1] + 1])
        row = np.repeat(rows, np.diff(facets.indptr[start : start + len(rows) + 1]))
        length = _lengths(centers, size, row, facets.indices[links], facets.image[links])
        k = link_conductivity(
            conductivity[row], conductivity[facets.indices[links]], facets.distance[links] / length, rule=rule
        )
        conductance[links] = k * facets.area[links] / length
    wall = conductivity[facets.wall_particle] * facets.wall_area / facets.wall_distance
    return Network(
        centers,
        np.asarray(size, dtype=float),
        facets.indptr,
        facets.indices,
        facets.image,
        conductance,
        facets.wall_particle,
        facets.wall_side,
        wall,
        facets.wall_area,
        facets.wall_distance,
        facets.volumes,
        phase,
        facets.wall_normal,
    )


def _lengths(centers, size, row, indices, image):
    """Distance between the centres of some links, (m,) float array, m."""
    total = np.zeros(len(indices))
    code = image.astype(np.int16)
    for k, shift in enumerate((code // 9 - 1, code // 3 % 3 - 1, code % 3 - 1)):
        x = centers[:, k]
        total += (x[indices] - x[row] + shift * size[k]) ** 2
    return np.sqrt(total)
