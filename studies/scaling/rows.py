"""What a row of scaling computes: a scene, and every stage from it to a conductivity with what the stage costs."""

import tempfile
import warnings

import numpy as np

from demheat.conduction.steady import solve_checked
from demheat.dem.options import Particles
from demheat.gallery import EPOXY, SILICA, dispersion, simple_cubic
from demheat.laws import Laguerre
from demheat.network.interface import connect
from demheat.network.laguerre import drop_empty_cells, laguerre
from demheat.network.repeated import farthest_of, known_cells
from demheat.packing.twins.conforming import conformed
from demheat.runtime.threads import thread_limit
from demheat.sampling.field_of import field_of
from studies.common import silica_epoxy
from studies.harness import methods
from studies.harness.cost import measured, triad_gbs

# Radius of the largest over that of the smallest sphere.
RATIOS = {"equal": 1.0, "polydisperse": 10.0}
CONTRAST = SILICA.conductivity / EPOXY.conductivity
# Where the field is asked for.
POINTS = 10_000
# Products of the network's matrix with a vector that are timed.
PRODUCTS = 10


def scene_of(number, kind, fraction):
    """So many spheres in a periodic cell under a mean gradient."""
    if number == 1:
        return simple_cubic(CONTRAST, fraction=fraction, matrix=EPOXY)
    return dispersion(number, fraction=fraction, ratio=RATIOS[kind])


def cell():
    """The cell of 83 spheres, a fifth of its volume."""
    return silica_epoxy.scene("periodic", 0.2, seed=0)


def warm_up(method):
    """Load and compile what a row of a method needs."""
    if method != "dem":
        methods.warm_up(method)
        return
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
        # More unknowns than those from which on multigrid is used.
        dem_row(cell(), 60_000, 0)


class Stages:
    """Costs of the stages of one row, one after the other."""

    def __init__(self):
        self.costs = {}

    def __call__(self, name, function, /, *args, **knobs):
        """Call a function as a stage; returns what it returns."""
        with warnings.catch_warnings():
            # Few particles on an inclusion do not resolve gaps; that is not what is measured here.
            warnings.filterwarnings("ignore", message=".*(do not fit into gaps|no particle lies)")
            value, self.costs[name] = measured(function, *args, **knobs)
        return value

    def row(self):
        """Seconds of every stage, their sums, and the peak of memory over what was there before the first."""
        cost = next(iter(self.costs.values()))
        first = cost["base_mib"]
        row = {f"{name}_{key}": cost[key] for name, cost in self.costs.items() for key in ("cpu_s", "wall_s")}
        row |= {key: sum(each[key] for each in self.costs.values()) for key in ("cpu_s", "wall_s")}
        peak = max(each["base_mib"] + each["peak_mib"] for each in self.costs.values()) - first
        return row | {"peak_mib": peak, "base_mib": first, "peak_by": cost["peak_by"]}


def dem_row(scene, particles, seed, *, cores=None):
    """Every stage of the DEM, its packing made anew."""
    law, stage = Laguerre(), Stages()
    with thread_limit(cores):
        asked = stage("packing", Particles(particles=particles, seed=seed).packed, scene, law)
        made = stage("twins", conformed, asked, scene, seed=seed, farthest=farthest_of(asked))
        packing = made.packing
        facets = stage("cells", _cells, asked, made)
        del made, asked
        packing, facets = drop_empty_cells(packing, facets)
        phase = stage("phases", scene.phase_at, packing.centers)
        network = stage("network", connect, packing, facets, phase, scene.conductivities, rule=law.interface)
        del facets
        solution = stage("equations", solve_checked, network, scene, solver="auto", tolerance=1e-8)
        field = stage("field", field_of, scene, network, solution, stats={})
        points = np.random.default_rng(seed).uniform(size=(POINTS, 3)) * scene.size
        row = stage.row()
        stage("points", lambda: (field.temperature_at(points), field.flux_at(points)))
        row |= {key: value for key, value in stage.row().items() if key.startswith("points")}
        row |= _product(network, cores)
    row |= {"twins": packing.provenance["twins"], "links": len(network.indices)}
    return row | _said(scene, field)


def _cells(asked, made):
    """The cells of a packing with its twins, those that tiles repeat cut once."""
    packing = made.packing
    known = known_cells(asked, made)
    return laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic, known=known)


def _product(network, cores):
    """Speed of the product of the network's matrix with a vector, beside what memory can deliver.

    A product must read a conductance and a neighbour's number of every link, the diagonal, the vector and the row
    pointers, and write the result.
    """
    from demheat.conduction.products import apply
    from demheat.network.links_kernels import links_of

    links, n = links_of(network), len(network.volumes)
    x, y, diagonal = np.ones(n), np.empty(n), np.ones(n)
    apply(links, diagonal, x, y)
    _, cost = measured(lambda: [apply(links, diagonal, x, y) for _ in range(PRODUCTS)])
    moved = 12 * len(network.indices) + 32 * n
    return {"product_gbs": 1e-9 * PRODUCTS * moved / cost["wall_s"], "triad_here_gbs": triad_gbs(threads=cores)}


def _said(scene, field):
    row = {"k_ratio": field.conductivity / EPOXY.conductivity, "inclusion": float(sum(field.fractions[1:]))}
    return (
        row
        | {"spheres": len(scene.inclusions)}
        | {name: field.stats.get(name) for name in ("unknowns", "iterations", "residual", "order")}
    )


def solved_row(scene, *, method, cores=None, **knobs):
    """Costs of one solve by another method, and of its field at points."""
    stage = Stages()
    knobs |= {} if cores is None else {"threads": cores}
    field = stage("solve", methods.load(method).solve, scene, **knobs)
    row = stage.row()
    points = np.random.default_rng(0).uniform(size=(POINTS, 3)) * scene.size
    stage("points", lambda: (field.temperature_at(points), field.flux_at(points)))
    return row | {key: value for key, value in stage.row().items() if key.startswith("points")} | _said(scene, field)
