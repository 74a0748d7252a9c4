"""Beds of overlapping grains, one temperature for each, whose conductivity is known by the law that a program prints.

A bed lies between two layers of grains held at 1 and 0 K, across x; nothing else exchanges heat. Each program has a law
of its own for what a contact conducts, so that a scene is an arrangement and a law: "chain, root of area". What the
laws are worth beside each other is in `disc`: the conductance of a contact over that of a disc between half-spaces.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

RADIUS, SOLID = 5e-3, 16.0
# Distance of neighbours over the sum of their radii.
NEAR = 0.98
# Of W/(m2 K): what a contact conducts for its area, where a law knows no conductivity.
PER_AREA = 4 * SOLID / RADIUS
# Below 1.1 some grains of the relaxed packing touch nothing.
RANDOM, GROWN = 1000, 1.1
# What free grains store, J/(m3 K): of no matter to a steady state.
STORED = 1e6
# Grains that take turns in a chain: radii over RADIUS, and conductivities over SOLID.
UNLIKE = ((1.0, 1.0), (0.7, 0.25), (1.3, 4.0))


class Bed(NamedTuple):
    """Grains between two held layers."""

    centers: np.ndarray  # (n, 3) float array, m
    radii: np.ndarray  # (n,) float array, m
    solid: np.ndarray  # (n,) float array, W/(m K)
    size: np.ndarray  # (3,) float array, m: Of the box; all centres are inside
    layer: float  # m: Grains whose centres are so near to x = 0 are held at 1 K, at the other end at 0 K
    length: float  # m: Over which the conductivity is counted; its area is the cross-section of the box
    law: str  # One of LAWS

    @property
    def held(self) -> np.ndarray:
        """Temperatures of grains that are held, K, NaN of the others: (n,) float array."""
        x = self.centers[:, 0]
        return np.where(x <= self.layer, 1.0, np.where(x >= self.size[0] - self.layer, 0.0, np.nan))

    def conductivity(self, heat: float) -> float:
        """Effective conductivity, W/(m K), by the heat in W that passes from layer to layer."""
        return heat * self.length / (self.size[1] * self.size[2])


class Scene(NamedTuple):
    """An arrangement of grains, and the law of their contacts."""

    arrangement: str
    law: str

    def drawn(self, n: int | None = None) -> Bed:
        """The bed, with n layers of grains or cells along x where that can be chosen."""
        draw = ARRANGEMENTS[self.arrangement][0]
        return (draw() if n is None else draw(n))._replace(law=self.law)


def circle(d, r, s):
    """Squared radius of the circle in which spheres cut each other, (m,) float array, m2."""
    return r**2 - ((d**2 + r**2 - s**2) / (2 * d)) ** 2


def hertz(d, r, s):
    """Squared contact radius of elastic spheres that overlap so far, (m,) float array, m2."""
    return (r + s - d) * r * s / (r + s)


# What a contact conducts, W/K, by distance, radii and conductivities; who prints it stands with the programs.
LAWS = {
    "disc": lambda d, r, s, k, p: 4 * np.sqrt(circle(d, r, s)) / (1 / k + 1 / p),
    "root of area": lambda d, r, s, k, p: 4 * k * p / (k + p) * np.sqrt(np.pi * circle(d, r, s)),
    "Hertz radius": lambda d, r, s, k, p: 4 * np.sqrt(hertz(d, r, s)) / (1 / k + 1 / p),
    "Hertz area": lambda d, r, s, k, p: PER_AREA * np.pi * hertz(d, r, s),
    "cylinder": lambda d, r, s, k, p: 2 * (k + p) * circle(d, r, s) / d,
    "whole grain": lambda d, r, s, k, p: 2 * (k + p) * r * s / d,
}


def _row(radii, solid):
    """Grains along x that overlap alike, in a box as wide as the widest."""
    steps = NEAR * (radii[1:] + radii[:-1])
    x = radii[0] + np.concatenate(([0.0], np.cumsum(steps)))
    wide = 2 * radii.max()
    centers = np.column_stack((x, np.full((len(x), 2), wide / 2)))
    size = np.array([x[-1] + radii[-1], wide, wide])
    return Bed(centers, radii, solid, size, 1.01 * max(radii[0], radii[-1]), x[-1] - x[0], "")


def _chain(n=10):
    return _row(np.full(n, RADIUS), np.full(n, SOLID))


def _unlike(n=10):
    kinds = np.array(UNLIKE)[np.arange(n) % len(UNLIKE)]
    return _row(RADIUS * kinds[:, 0], SOLID * kinds[:, 1])


def _cubic(n=8):
    """Simple cubic: n layers of columns side by side."""
    d, across = 2 * NEAR * RADIUS, max(2, n // 2)
    grid = np.stack(np.meshgrid(np.arange(n), *[np.arange(across)] * 2, indexing="ij"), axis=-1).reshape(-1, 3)
    size = d * np.array([n, across, across])
    return _alike((grid + 0.5) * d, size, 0.75 * d, (n - 1) * d)


def _centred(n=6):
    """Body-centred: cells with their eight corners, which belong to it wholly."""
    edge, across = 4 * NEAR * RADIUS / np.sqrt(3), max(2, n // 2)
    counts = np.array([n, across, across])
    corners, middles = (
        np.stack(np.meshgrid(*(np.arange(c + more) for c in counts), indexing="ij"), axis=-1).reshape(-1, 3)
        for more in (1, 0)
    )
    # Of no matter to the heat, but boxes are to hold what grains stick out.
    margin = RADIUS
    centers = np.concatenate((corners, middles + 0.5)) * edge + [margin, 0, 0]
    return _alike(centers, edge * counts + [2 * margin, 0, 0], margin + 0.25 * edge, n * edge)


def _random():
    """A relaxed packing between walls, its radii grown until each grain has contacts."""
    from demheat.packing.cache import relaxed

    packing = relaxed(RANDOM, size=(0.1, 0.1, 0.1), periodic=False, seed=7)
    bed = _alike(packing.centers, packing.size, 2 * packing.radii.mean(), packing.size[0])
    return bed._replace(radii=GROWN * packing.radii)


def _alike(centers, size, layer, length):
    grains = np.ones(len(centers))
    return Bed(centers, RADIUS * grains, SOLID * grains, size, layer, length, "")


def _one(law):
    """A contact of two equal grains."""
    alike = np.array([RADIUS])
    return float(LAWS[law](2 * NEAR * alike, alike, alike, SOLID, SOLID)[0])


def _of_row(law, draw):
    """Contacts in series."""
    bed = draw()
    d, r, k = np.diff(bed.centers[:, 0]), bed.radii, bed.solid
    passes = 1 / np.sum(1 / LAWS[law](d, r[1:], r[:-1], k[1:], k[:-1]))
    return bed.conductivity(float(passes))


def _of_columns(law):
    """A contact on each square of the side d."""
    return _one(law) / (2 * NEAR * RADIUS)


def _of_cells(law):
    """Four contacts in each of two gaps of a cell between planes of one temperature."""
    return 2 * _one(law) * np.sqrt(3) / (4 * NEAR * RADIUS)


def _by_elimination(law):
    return eliminated(_random()._replace(law=law))


# Name: how it is drawn, and its conductivity by a law, W/(m K).
ARRANGEMENTS = {
    "chain": (_chain, lambda law: _of_row(law, _chain)),
    "unlike chain": (_unlike, lambda law: _of_row(law, _unlike)),
    "simple cubic": (_cubic, _of_columns),
    "body-centred": (_centred, _of_cells),
    "random bed": (_random, _by_elimination),
}
BEDS = {f"{name}, {law}": Scene(name, law) for name in ARRANGEMENTS for law in LAWS}
# Layers of grains or cells that rows have, few and many where few do not tell; at random there is one size.
LAYERS = {"chain": (10, 40), "unlike chain": (10,), "simple cubic": (8, 16), "body-centred": (6, 12), "random bed": ()}


def cases(law, *, most=None):
    """Scene and layers of all arrangements by a law, of each so many numbers of layers at most."""
    for name, layers in LAYERS.items():
        yield from ({"scene": f"{name}, {law}"} | knobs for knobs in [{"n": n} for n in layers[:most]] or [{}])


@cache
def known(name: str) -> float:
    """Conductivity of a bed between its held layers, W/(m K), by its law: in closed form, at random by elimination."""
    scene = BEDS[name]
    return float(ARRANGEMENTS[scene.arrangement][1](scene.law))


def pairs(bed: Bed):
    """Grains that overlap, by all distances: numbers first < second, (m,) int arrays, and distances, (m,) array, m."""
    apart = np.linalg.norm(bed.centers[:, None] - bed.centers, axis=2)
    first, second = np.nonzero(np.triu(apart < bed.radii[:, None] + bed.radii, 1))
    return first, second, apart[first, second]


def conductances(bed: Bed):
    """Grains that overlap, and what they conduct by the bed's law: first, second, (m,) float array, W/K."""
    first, second, d = pairs(bed)
    r, k = bed.radii, bed.solid
    return first, second, LAWS[bed.law](d, r[first], r[second], k[first], k[second])


def eliminated(bed: Bed) -> float:
    """Conductivity of a bed by Gaussian elimination on its full matrix, W/(m K)."""
    first, second, conductance = conductances(bed)
    matrix = np.zeros(2 * (len(bed.radii),))
    np.add.at(matrix, (np.concatenate((first, second)), np.concatenate((second, first))), -np.tile(conductance, 2))
    matrix -= np.diag(matrix.sum(axis=1))
    free = np.isnan(bed.held)
    warmth = np.where(free, 0.0, bed.held)
    warmth[free] = np.linalg.solve(matrix[np.ix_(free, free)], -(matrix @ warmth)[free])
    return bed.conductivity(float((matrix @ warmth)[bed.held == 1.0].sum()))


def march(bed: Bed, *, accuracy: float = 1e-10) -> tuple[float, int]:
    """Step and number of steps in which explicit Euler gets so near to the steady state."""
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import eigsh

    first, second, conductance = conductances(bed)
    free, n = np.isnan(bed.held), len(bed.radii)
    total = np.bincount(first, conductance, n) + np.bincount(second, conductance, n)
    stored = STORED * 4 / 3 * np.pi * bed.radii**3
    step = float(np.min((stored / total)[free]))
    links = coo_array((conductance, (first, second)), shape=(n, n))
    matrix = (diags_array(total) - links - links.T).tocsc()[free][:, free]
    slowest = eigsh(matrix, 1, M=diags_array(stored[free]).tocsc(), sigma=0.0, which="LM", return_eigenvectors=False)
    return step, int(np.ceil(-np.log(accuracy) / -np.log1p(-step * float(slowest[0]))))


def solved(scene: Scene, n: int | None = None) -> dict:
    """The bed by `demheat.grains`: its own law where it has it, else the contact radii that give the same."""
    from studies.harness.cost import measured

    bed = scene.drawn(n)
    field, cost = measured(network, bed)
    found = bed.conductivity(field.wall_heat["x-"] / drop(field))
    return {"conductivity": float(found), "version": "", "unknowns": len(bed.radii)} | {
        "iterations": field.stats.get("iterations"),
        **cost,
    }


def network(bed: Bed):
    """The solved GrainField of a bed."""
    from demheat import grains
    from demheat.packing import Packing

    packing = Packing(bed.centers, bed.radii, bed.size, np.zeros(3, dtype=bool), {})
    own = {"disc": grains.Overlap(), "Hertz radius": grains.Hertz()}
    if bed.law in own:
        contact = own[bed.law]
    else:
        first, second, conductance = conductances(bed)
        contact = grains.Contacts(
            first, second, radius=conductance * (1 / bed.solid[first] + 1 / bed.solid[second]) / 4
        )
    return grains.solve(packing, bed.solid, walls={"x-": 1.0, "x+": 0.0}, contact=contact, layer=bed.layer)


def drop(field) -> float:
    """Difference of the temperatures that held grains have, a little less than 1 K, weighted with their heat."""
    heat, warmth = field.heat_from_walls, field.temperature[field.at_walls.grain]
    hot, cold = heat > 0, heat < 0
    return float(heat[hot] @ warmth[hot] / heat[hot].sum() - heat[cold] @ warmth[cold] / heat[cold].sum())


def flows(bed: Bed, warmth) -> tuple[dict, np.ndarray]:
    """Heat that `demheat.grains` has contacts and grains exchange at given temperatures."""
    pairs, warmth = network(bed).pairs, np.asarray(warmth)
    heat = pairs.conductance * (warmth[pairs.second] - warmth[pairs.first])
    n = len(bed.radii)
    received = np.bincount(pairs.first, heat, n) - np.bincount(pairs.second, heat, n)
    rise = np.sign(pairs.second - pairs.first)
    couples = np.sort(np.column_stack((pairs.first, pairs.second)), axis=1)
    return dict(zip(map(tuple, couples.tolist()), rise * heat, strict=True)), received
