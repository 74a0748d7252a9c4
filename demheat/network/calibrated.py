"""The papers' contact network: links between touching particles with transmission surfaces pi R_m^2 (C_t = 1).

Source: Haddad et al. 2021, eqs. 2-3 and 7-9.
"""

import numpy as np
from scipy.spatial import cKDTree

from demheat.network.base import Facets, row_numbers
from demheat.packing.neighbours import contacts

# The papers impose wall temperatures at the centres of the particles that touch the wall. A wall link this short, in
# radii, holds the centre at the wall's temperature to 1e-4 of the drop over one link.
ISOTHERMAL = 1e-4


def contact_facets(packing, *, coordination=7.5, least_links=2):
    """Contact network of a packing with S = pi R_m^2, R_m the mean of two radii (C_t = 1).

    Parameters
    ----------
    packing : Packing
    coordination : float
        Mean number of links; it sets the detection gap, since hard spheres touch six others on average at most.
    least_links : int
        A particle with fewer links is joined to its nearest neighbours (by surface distance) until it has as many;
        0 leaves particles that touch nobody as islands.

    Returns
    -------
    Facets
        Volumes are V_p over the packing fraction, so that they fill the box. Facets divide a link by the radii.
    """
    indptr, indices, _ = contacts(packing, coordination=coordination)
    rows, columns = _joined(packing, row_numbers(indptr), indices.astype(np.int64), least_links)
    offsets, image = _nearest_image(packing, rows, columns)
    here, there = packing.radii[rows], packing.radii[columns]
    length = np.linalg.norm(offsets, axis=1)
    pointers = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=packing.number))])
    volumes = packing.radii**3 * (np.prod(packing.size) / np.sum(packing.radii**3))
    area = np.pi * (0.5 * (here + there)) ** 2
    walls = _wall_contacts(packing)
    return Facets(pointers, columns.astype(np.uint32), image, area, length * here / (here + there), *walls, volumes)


def _joined(packing, rows, columns, least):
    """Rows and columns with links added, both ways, from each particle with fewer than `least` to its nearest."""
    degree = np.bincount(rows, minlength=packing.number)
    poor = np.flatnonzero(degree < least)
    if len(poor) == 0:
        return rows, columns
    box = np.where(packing.periodic, packing.size, 0.0)
    most = min(packing.number, 33)
    _, near = cKDTree(packing.centers, boxsize=box).query(packing.centers[poor], k=most)
    pairs = set(zip(rows.tolist(), columns.tolist(), strict=True))
    for p, candidates in zip(poor.tolist(), near, strict=True):
        candidates = candidates[candidates != p]
        offsets, _ = _nearest_image(packing, np.full(len(candidates), p), candidates)
        surface = np.linalg.norm(offsets, axis=1) - packing.radii[candidates]
        for q in candidates[np.argsort(surface, kind="stable")].tolist()[:least]:
            pairs |= {(p, q), (q, p)}
    both = np.array(sorted(pairs))
    return both[:, 0], both[:, 1]


def _nearest_image(packing, rows, columns):
    """Offsets to the nearest image of each column's particle, and the image's code."""
    offsets = packing.centers[columns] - packing.centers[rows]
    shift = np.where(packing.periodic, -np.round(offsets / packing.size), 0.0)
    code = (shift + 1.0) @ np.array([9.0, 3.0, 1.0])
    return offsets + shift * packing.size, code.astype(np.uint8)


def _wall_contacts(packing):
    """Particles that touch a wall, as (particle, side, area, distance)."""
    particle, side, area = [np.empty(0, np.int64)], [np.empty(0, np.int64)], [np.empty(0)]
    for s in range(6):
        if packing.periodic[s // 2]:
            continue
        x = packing.centers[:, s // 2]
        height = packing.size[s // 2] - x if s % 2 else x
        touching = np.flatnonzero(height <= packing.radii * (1.0 + 1e-3))
        particle.append(touching)
        side.append(np.full(len(touching), s))
        wall = np.prod(np.delete(packing.size, s // 2))
        share = packing.radii[touching] ** 2
        area.append(wall * share / share.sum())  # together the whole wall, so that an imposed flux enters in full
    particle, side, area = (np.concatenate(parts) for parts in (particle, side, area))
    return particle, side, area, ISOTHERMAL * packing.radii[particle]
