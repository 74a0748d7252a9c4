"""Links that are gone from a network."""

import numpy as np

from demheat.damage.inclusions import drawn
from demheat.network.base import Network, row_numbers


def without_links(network: Network, share: float, *, seed: int) -> Network:
    """A network in which a share of the links, drawn at random, conducts nothing.

    Parameters
    ----------
    network : Network
    share : float
        Of the links between particles that conduct, from 0 to 1; those to walls stay. With one seed a larger share is
        the same draw and more.
    seed : int
        Of NumPy's default generator.

    Returns
    -------
    Network
        That is not `whole`: what hangs together is looked for as beside pores, and carries exactly nothing where no
        heat can pass.

    Raises
    ------
    ValueError
        If an argument is not as described.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import Laguerre, damage, gallery
    >>> from demheat.dem.networks import network_of
    >>> from demheat.packing.relax import relax
    >>> network = network_of(gallery.slab(size=(1.0, 1.0, 1.0), periodic=True), relax(500, seed=0), Laguerre())
    >>> fewer = damage.without_links(network, 0.25, seed=0)
    >>> print(f"{np.count_nonzero(fewer.conductance) / np.count_nonzero(network.conductance):.3f}")
    0.750
    """
    first, second = pairs(network)
    conducts = network.conductance[first] > 0
    first, second = first[conducts], second[conducts]
    return cut(network, (first, second), drawn(len(first), share, seed))


def pairs(network) -> tuple[np.ndarray, np.ndarray]:
    """Places of both ends of each link, two (m / 2,) int arrays."""
    here, there = row_numbers(network.indptr), network.indices.astype(np.int64)
    n, code = len(network.volumes), network.image.astype(np.int64)
    # Seen from its other end a link leads to the opposite image.
    forth, back = (here * n + there) * 27 + code, (there * n + here) * 27 + 26 - code
    mate = np.empty(len(forth), np.int64)
    mate[np.argsort(forth)] = np.argsort(back)
    first = np.flatnonzero(np.arange(len(mate)) < mate)
    return first, mate[first]


def cut(network, both, gone) -> Network:
    """A network without the conductances of some links."""
    if not np.any(gone):
        return network
    conductance = network.conductance.copy()
    for end in both:
        conductance[end[gone]] = 0.0
    return network._replace(conductance=conductance, whole=False)
