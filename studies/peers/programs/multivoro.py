"""Voro++ by its Python wrapper multivoro: radical cells of our packing in place of ours, then our network and solver.

What is compared is the tessellation: the conductivity by Voro++'s cells beside that by ours, areas facet by facet, and
the sum of volumes. Cost is that of the cells alone, on one thread. The wrapper's cells have vertices and faces, in
coordinates of the box; areas and volumes are computed here. Its documentation prints no value that can be run.
"""

import tempfile
from pathlib import Path

import numpy as np

from studies.peers import packages
from studies.peers.outside import Found, asked, python_of

TITLE = "Voro++ (multivoro)"
KIND = "packing"
GET = "pip: multivoro"
CANNOT = {
    "conductivities": "it cuts cells; packing, network and solver are ours",
    "round bodies": "walls of boxes alone in this wrapper",
    "areas and volumes": "the wrapper returns vertices and faces only",
}
BODIES = ("homogeneous", "layers off the grid", "sphere 10", "sphere 0.01", "half 10")
CASES = tuple({"scene": body, "particles": 2000} for body in BODIES) + (
    {"scene": "sphere 10", "particles": 2000, "conforming": False},
    {"scene": "sphere 10", "particles": 20_000},
    {"scene": "half 10", "particles": 20_000},
)
EXPLAINED = "the error is that of the network, which is ours, to rounding"
SCRIPT = Path(__file__).parent / "scripts" / "multivoro_cells.py"
# Facets this small, in squared mean spacings, are rounding where more than four cells meet: as ours leaves them out.
SLIVER = 1e-11
missing, version = packages.asked_of("multivoro", GET)


def solve(scene, *, particles, conforming=True) -> Found:
    """Conductivity by a network on cells of Voro++."""
    from demheat.packing.cache import relaxed
    from demheat.packing.twins.conforming import conform

    if getattr(scene, "domain", None) != "box" or scene.periodic:
        raise NotImplementedError("multivoro: rows are of boxes between walls; round bodies it has not")
    packing = relaxed(particles, size=scene.size, periodic=False)
    if conforming:
        packing = conform(packing, scene)
    facets, cost = cells(packing)
    ours, our_cost = _ours(packing)
    value, same = (_conductivity(scene, packing, each) for each in (facets, ours))
    note = (
        f"volumes off the box by {abs(facets.volumes.sum() / np.prod(packing.size) - 1):.0e}, areas from ours by "
        f"{_apart(facets, ours):.0e}, conductivity by {abs(value / same - 1):.0e}; CPU {cost['cpu_s']:.3g} s, ours "
        f"{our_cost['cpu_s']:.3g} s"
    )
    return Found(value, cost, unknowns=packing.number, note=note)


def cells(packing):
    """Cells of Voro++ as Facets, and what they cost."""
    with tempfile.TemporaryDirectory() as folder:
        limits = np.array([np.zeros(3), packing.size])
        np.savez(Path(folder, "given.npz"), centers=packing.centers, radii=packing.radii, limits=limits)
        found = asked(python_of("multivoro"), SCRIPT, {"folder": folder}, environment={"OMP_NUM_THREADS": "1"})
        with np.load(Path(folder, "cells.npz")) as raw:
            return facets_of(packing, {name: raw[name] for name in raw.files}), found["cost"]


def facets_of(packing, raw):
    """Facets of cells that are given by their faces."""
    from demheat.network.base import Facets

    n, owner, neighbour = packing.number, raw["owner"].astype(int), raw["neighbour"].astype(int)
    area = _areas(raw)
    spacing = (packing.volume / n) ** (1 / 3)
    # Links stand in both rows; of a sliver the two cells may differ.
    link = np.flatnonzero((neighbour >= 0) & (area > SLIVER * spacing**2))
    link = link[np.lexsort((neighbour[link], owner[link]))]
    p, q = owner[link], neighbour[link]
    mirrored = np.lexsort((p, q))
    if not np.array_equal(p[mirrored], q) or not np.array_equal(q[mirrored], p):
        raise RuntimeError("multivoro: a face stands in one of its two cells only")
    apart = np.linalg.norm(packing.centers[q] - packing.centers[p], axis=1)
    distance = (apart**2 + packing.radii[p] ** 2 - packing.radii[q] ** 2) / (2 * apart)
    wall = np.flatnonzero(neighbour < 0)
    wall = wall[area[wall] > SLIVER * spacing**2]
    grain, side = owner[wall], -1 - neighbour[wall]
    place = packing.centers[grain, side // 2]
    to_wall = np.where(side % 2, packing.size[side // 2] - place, place)
    volumes = (np.bincount(p, area[link] * distance, n) + np.bincount(grain, area[wall] * to_wall, n)) / 3
    normal = np.zeros((len(wall), 3))
    normal[np.arange(len(wall)), side // 2] = np.where(side % 2, 1.0, -1.0)
    indptr = np.concatenate(([0], np.cumsum(np.bincount(p, minlength=n)))).astype(np.int64)
    image = np.full(len(p), 13, dtype=np.uint8)
    both = (area[link] + area[link][mirrored]) / 2
    return Facets(indptr, q.astype(np.uint32), image, both, distance, grain, side, area[wall], to_wall, volumes, normal)


def _areas(raw):
    """Areas of plane polygons, (f,) float array, m2."""
    length, point = raw["length"].astype(int), raw["point"][raw["corner"]]
    begin = np.cumsum(length) - length
    after = np.arange(len(point)) + 1
    after[begin + length - 1] = begin
    # Relative to a corner of the face: far from it areas are small differences.
    origin = np.repeat(point[begin], length, axis=0)
    swept = np.cross(point - origin, point[after] - origin)
    face = np.repeat(np.arange(len(length)), length)
    sums = np.column_stack([np.bincount(face, swept[:, axis], len(length)) for axis in range(3)])
    return np.linalg.norm(sums, axis=1) / 2


def _ours(packing):
    from demheat.network.laguerre import laguerre
    from studies.harness.cost import measured

    small = np.random.default_rng(0).random((200, 3)) * packing.size
    laguerre(small, np.zeros(200), packing.size, periodic=False)  # loads the compiled kernels
    return measured(laguerre, packing.centers, packing.radii**2, packing.size, periodic=False)


def _conductivity(scene, packing, facets):
    """By our network on facets and our solver."""
    from demheat.conduction.steady import solve_checked
    from demheat.laws import Laguerre
    from demheat.network.interface import connect
    from demheat.network.laguerre import drop_empty_cells
    from demheat.sampling.field_of import field_of

    packing, facets = drop_empty_cells(packing, facets)
    law = Laguerre()
    network = connect(
        packing, facets, scene.phase_at(packing.centers), scene.conductivities, rule=law.interface, cells=law.cells
    )
    network = network._replace(stats={"law": law.name, "calibration": 1.0, "packing": packing.provenance})
    solution = solve_checked(network, scene, solver="auto", tolerance=1e-12)
    return field_of(scene, network, solution, stats={}).conductivity


def _apart(facets, ours):
    """Largest difference of areas of a link, over the mean area; links that one of them lacks count wholly."""
    from demheat.network.base import row_numbers

    n = len(ours.volumes)
    keys, areas = [], []
    for each in (facets, ours):
        key = row_numbers(each.indptr) * n + each.indices
        order = np.argsort(key)
        keys.append(key[order]), areas.append(each.area[order])
    every = np.union1d(*keys)
    spread = np.zeros((2, len(every)))
    for row, key, area in zip(spread, keys, areas, strict=True):
        row[np.searchsorted(every, key)] = area
    return float(np.max(np.abs(spread[0] - spread[1])) / ours.area.mean())
