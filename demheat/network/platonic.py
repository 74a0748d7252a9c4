"""Contact network with the surfaces and capacities of regular polyhedra and crystals, by number of neighbours.

Source: Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46, section 4 and table 1.
"""

import math
from itertools import product

import numpy as np

from demheat.laws import Platonic
from demheat.network.base import Facets
from demheat.network.calibrated import LEAST_GAP, at_walls, heights, joined_facets, walls_of
from demheat.packing.neighbours import contacts

# Edges of a face and faces at a vertex of the regular polyhedra.
SOLIDS = ((3, 3), (4, 3), (3, 4), (5, 3), (3, 5))
FACE_CENTRED = ((0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0))
# Sites in the cubic cell of the crystals that stand for a packing.
CRYSTALS = {
    "diamond": (*FACE_CENTRED, *(tuple(x + 0.25 for x in site) for site in FACE_CENTRED)),
    "simple cubic": ((0, 0, 0),),
    "body-centred cubic": ((0, 0, 0), (0.5, 0.5, 0.5)),
    "face-centred cubic": FACE_CENTRED,
}


def solid_face(edges, meeting):
    """Number of faces of a regular polyhedron around a unit sphere, and the area of one.

    Half the dihedral angle t has sin t = cos(pi/meeting) / sin(pi/edges); a face that touches the sphere has the
    inscribed circle of radius cot t.
    """
    faces = 4 * meeting // (4 - (edges - 2) * (meeting - 2))
    half = math.asin(math.cos(math.pi / meeting) / math.sin(math.pi / edges))
    return faces, edges * math.tan(math.pi / edges) / math.tan(half) ** 2


def crystal_packing(sites):
    """Contacts of each sphere of a crystal whose spheres touch, and its packing fraction."""
    cells = np.array(list(product((-1, 0, 1), repeat=3)))
    apart = np.linalg.norm((np.array(sites)[None] + cells[:, None]).reshape(-1, 3) - sites[0], axis=1)
    nearest = apart[apart > 0].min()
    # Rounding of distances of order one.
    neighbours = int(np.sum(abs(apart - nearest) < 1e-9))
    return neighbours, len(sites) * math.pi / 6 * float(nearest) ** 3


SURFACES = np.array(sorted(solid_face(*solid) for solid in SOLIDS)).T
FRACTIONS = np.array([(0, 0.0), *sorted(crystal_packing(sites) for sites in CRYSTALS.values())]).T


def surface_factors(neighbours):
    """Transmission surface s(n) of one link of a particle with n of them, in units of its squared radius.

    The face of the regular polyhedron with n faces around the unit sphere; linear between those that there are, and
    along the first and the last of these lines beyond 4 and 20 (Terreros et al. 2013, table 1). The last line reaches
    zero between 29 and 30, where the packing fraction passes one: more neighbours are refused.
    """
    neighbours = _checked(neighbours)
    return _lines(neighbours, *SURFACES)


def fraction_factors(neighbours):
    """Local packing fraction f(n) around a particle with n neighbours.

    That of the crystal with n contacts, 0 without any; linear between, and along the last line beyond 12 (Terreros et
    al. 2013, table 1).
    """
    return _lines(_checked(neighbours), *FRACTIONS)


def _checked(neighbours):
    neighbours = np.asarray(neighbours)
    if neighbours.dtype.kind not in "iu" or np.any(neighbours < 0):
        raise ValueError(f"neighbours = {neighbours}: must be integers >= 0")
    many = neighbours[_lines(neighbours, *SURFACES) <= 0]
    if len(many):
        raise ValueError(
            f"neighbours = {int(many.max())}: the Platonic law has surfaces for at most 29; lower the coordination, or "
            "use radii that differ less"
        )
    return neighbours


def _lines(x, knots, values):
    """Linear between knots, and along the first and last line beyond them."""
    k = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(knots) - 2)
    slope = np.diff(values) / np.diff(knots)
    return values[k] + slope[k] * (x - knots[k])


def platonic_facets(packing, law: Platonic) -> Facets:
    """Contact network of a packing with S_pq = sqrt(S_p S_q), S_p = s(n_p) R_p^2, for n_p neighbours of a particle."""
    links = contacts(packing, coordination=law.coordination, gap=law.gap)
    facets = joined_facets(packing, links, sparse=law.sparse)
    # What is taken out has no volume there.
    neighbours = np.where(facets.volumes > 0, count_neighbours(packing, facets.indptr, links[2]), 0)
    surface = surface_factors(neighbours) * packing.radii**2
    area = np.sqrt(np.repeat(surface, np.diff(facets.indptr)) * surface[facets.indices])
    facets = facets._replace(area=area, volumes=carrying_volumes(packing.radii, neighbours))
    return at_walls(packing, facets, law.wall)


def count_neighbours(packing, indptr, gap=0.0):
    """Neighbours n_p of each particle: its links, and the walls within the gap of it.

    The paper does not say whether a wall is one. With it the simple cubic crystal of the paper's section 3 is the
    finite-difference stencil up to its faces; without it particles there would get larger surfaces and volumes.
    """
    reach = packing.radii * (1.0 + max(gap, LEAST_GAP))
    return np.diff(indptr) + sum(heights(packing, side) <= reach for side in walls_of(packing))


def carrying_volumes(radii, neighbours):
    """Volume whose heat a particle carries, V_p / f(n_p); none without neighbours."""
    spheres = 4 / 3 * np.pi * radii**3
    return np.divide(spheres, fraction_factors(neighbours), out=np.zeros(len(radii)), where=neighbours > 0)
