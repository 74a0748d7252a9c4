"""Small random networks, as kernels take them: nothing but compressed rows, every link in both of its rows."""

from types import SimpleNamespace

import numpy as np

from demheat.network.links_kernels import Links, Places

SIZE = np.array([1.0, 1.3, 0.8])


def random_links(n, *, per_row=6, seed=0, single=False):
    """Links and places of n random points, linked at random over random periodic images.

    A tenth of the links conducts nothing, the last point has none. With `single` no two points are linked twice, nor
    any to itself.
    """
    rng = np.random.default_rng(seed)
    here, there = rng.integers(0, n - 1, (2, n * per_row // 2))
    image = rng.integers(0, 27, len(here))
    kept = image != 13
    if single:
        _, first = np.unique(np.sort([here, there], axis=0), axis=1, return_index=True)
        kept = np.isin(np.arange(len(here)), first) & (here != there)
    here, there, image = here[kept], there[kept], image[kept]
    conductance = rng.lognormal(0.0, 1.0, len(here)) * (rng.random(len(here)) > 0.1)
    row = np.concatenate([here, there])
    order = np.argsort(row, kind="stable")
    indptr = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=n))])
    links = Links(indptr, np.concatenate([there, here])[order].astype(np.uint32), np.tile(conductance, 2)[order])
    codes = np.concatenate([image, 26 - image])[order].astype(np.uint8)
    return links, Places(rng.random((n, 3)) * SIZE, SIZE, codes)


def balanced(n, seed=0):
    """Links and a diagonal that makes a positive matrix; the last point has no link and no equation."""
    links, _ = random_links(n, seed=seed)
    total = np.add.reduceat(np.append(links.conductance, 0.0), links.indptr[:-1]) * (np.diff(links.indptr) > 0)
    diagonal = total + np.where(np.arange(n) % 7 == 0, 0.5, 0.0)
    diagonal[-1] = 0.0
    return links, diagonal


def network_of(links, places, area):
    """What products take of a network."""
    return SimpleNamespace(**links._asdict(), **places._asdict(), area=area)


def each_link(links):
    """Row, number, other end and conductance of one link after the other."""
    for i in range(len(links.indptr) - 1):
        for e in range(links.indptr[i], links.indptr[i + 1]):
            yield i, e, int(links.indices[e]), links.conductance[e]


def dense(links, diagonal):
    """The matrix diag(diagonal) - conductance, (n, n) float array."""
    a = np.diag(np.asarray(diagonal, dtype=float))
    for i, _, j, g in each_link(links):
        a[i, j] -= g
    return a


def branch(i, e, links, places):
    """Vector from a point to the image of its neighbour."""
    shift = np.array(np.unravel_index(int(places.image[e]), (3, 3, 3))) - 1
    return places.centers[links.indices[e]] + shift * places.size - places.centers[i]


def received(i, e, links, places, gradient, x):
    """Heat that a point receives over one of its links, temperatures x on top of a linear field."""
    rise = x[links.indices[e]] - x[i] + gradient @ branch(i, e, links, places)
    return links.conductance[e] * rise
