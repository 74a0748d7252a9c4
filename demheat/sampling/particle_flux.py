"""Flux of each particle as the mean of what flows through its part of every link.

Source: Haddad et al. 2021, eq. 20.
"""

import numpy as np

from demheat.network.base import link_distances, wall_normals
from demheat.network.links_kernels import links_of, places_of
from demheat.runtime.threads import shared_out
from demheat.sampling import particle_flux_kernels as kernels

# Rows that a thread does at a time.
PIECE = 32768
SPLITS = {"half": kernels.HALF, "radii": kernels.RADII, "cell": kernels.CELL}


def particle_flux(network, solution, *, split="half"):
    """Flux density of each particle, q_p = -(1 / V_p) sum over links of s W b.

    W is the heat that the particle receives over a link, b the branch vector to the other particle, V_p the volume that
    the particle stands for (V_p / phi for contacts) and s the part of the link that is its own. The two parts of a link
    add up to one, so the flux averaged by volume over a periodic cell is the first moment of the heat flows with every
    split. The paper's eq. 20 has one half, which no single particle has unless it is as large as its neighbours, and
    the opposite sign.
    """
    if split not in SPLITS:
        raise ValueError(f"split = {split!r}: must be one of {', '.join(SPLITS)}")
    sizes = {"network": len(network.volumes), "solution": len(solution.temperature)}
    if len(set(sizes.values())) > 1:
        raise ValueError(f"network, solution: must be of the same particles, not {sizes}")
    flow = np.empty((len(network.volumes), 3))
    state = links_of(network), places_of(network), solution.mean_gradient, np.nan_to_num(solution.temperature)
    how = network.radii, link_distances(network), SPLITS[split]
    shared_out(kernels.shared_moments, len(flow), *state, *how, flow, piece=PIECE)
    if split == "cell":
        depth = (network.wall_distance * solution.wall_heat)[:, None] * wall_normals(network)
        np.add.at(flow, network.wall_particle, depth)
    return -flow / network.volumes[:, None]
