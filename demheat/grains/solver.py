"""Steady heat conduction through a bed of grains: contacts, gaps, and the temperatures at which each grain balances."""

import time
import warnings
from collections.abc import Mapping, Sequence

import numpy as np

from demheat.conduction.steady import check_solver, solve_checked
from demheat.grains.field import GrainField, Load
from demheat.grains.laws import Fixed, Gap, Hertz, Overlap, check_conductivity
from demheat.grains.pairs import Contacts, at_walls, check_laws, checked_contacts, in_layers, pairs_of
from demheat.network.base import SIDES, Network, branches, row_numbers, without_links
from demheat.packing.base import Packing
from demheat.packing.gate import check_packing
from demheat.packing.walls import wall_distance
from demheat.packing.walls import walls as walls_of
from demheat.sampling.fluxes import filled, mean_flux
from demheat.scene import Layer, Material, Scene
from demheat.scene.inputs import finite, reals


def solve(
    packing: Packing,
    solid: float | Sequence[float],
    *,
    walls: Mapping[str, float] | None = None,
    gradient: Sequence[float] | None = None,
    contact: Overlap | Hertz | Fixed | Contacts | None = None,
    gap: Gap | None = None,
    layer: float | None = None,
    tolerance: float = 1e-10,
) -> GrainField:
    """Steady temperatures of grains, the heat that pairs of them exchange, and the conductivity of the bed.

    Each grain has one temperature; pairs exchange heat by the laws of `demheat.grains.laws`. What passes through the
    medium elsewhere than in gaps is left out, as is radiation: see docs/decisions/grains.md for what that costs.

    Parameters
    ----------
    packing : Packing
        As `demheat.io.packings.read` reads it from a file, in metres; grains may overlap.
    solid : float or (n,) sequence of float, W/(m K)
        Conductivity of the grains.
    walls : mapping of str to float, K or degrees Celsius
        Temperatures of walls of the packing's box; other faces are insulated, or periodic as the packing is. Either
        this or `gradient`.
    gradient : (3,) sequence of float, K/m
        Mean temperature gradient, along axes of which the packing is periodic.
    contact : Overlap, Hertz, Fixed or Contacts, optional
        How large contacts are; by default Overlap().
    gap : Gap, optional
        The medium; None is a vacuum.
    layer : float, m, optional
        Grains whose centres are so near a wall have its temperature. By default walls act through contacts and gaps
        with the grains beside them.
    tolerance : float
        On the relative residual of the heat balance.

    Returns
    -------
    GrainField
        Grains that no heat reaches have no temperature, NaN, as in a vacuum those without contacts.

    Raises
    ------
    ValueError
        If an argument is not as described, or no grain touches or is near a wall that has a temperature.
    NotImplementedError
        If the packing is not in a box, or a periodic box is so small that grains meet each other twice.
    RuntimeError
        If the residual misses the tolerance.

    Examples
    --------
    >>> from demheat import grains
    >>> from demheat.packing import make_packing
    >>> row = make_packing([[1, 1, 0.99], [1, 1, 2.97]], [1.0, 1.0], (2, 2, 3.96), False, {})
    >>> field = grains.solve(row, 16.0, walls={"z-": 0.0, "z+": 1.0}, contact=grains.Fixed(ratio=0.1))
    >>> field.temperature.round(12).tolist()  # a wall has no half-space of its own to cross
    [0.25, 0.75]
    """
    contact = Overlap() if contact is None else contact
    check_packing(packing)
    check_laws(contact, gap)
    check_solver("auto", tolerance)
    solid = _conductivities(packing, solid)
    scene = _load(packing, walls, gradient)
    contact = checked_contacts(packing, contact) if isinstance(contact, Contacts) else contact
    begun = time.perf_counter()
    pairs = pairs_of(packing, solid, contact, gap)
    sides = tuple(scene.walls or ())
    if layer is not None:
        _check_layer(packing, layer, sides)
        held = in_layers(packing, pairs, layer, sides)
    else:
        held = at_walls(packing, solid, contact, gap, sides) if sides else None
    _check_reached(packing, held, sides)
    if gap is not None and not len(pairs.first) and not sides:
        warnings.warn("no two grains touch or are within reach of the gap: the bed conducts nothing", stacklevel=2)
    network, order = _network(packing, pairs, held)
    made = time.perf_counter()
    solution = solve_checked(network, scene, solver="auto", tolerance=tolerance)
    if solution.still is not None:
        network = without_links(network, solution.still)
    spent = {"network_s": made - begun, "solve_s": time.perf_counter() - made}
    load = Load(scene.walls, scene.gradient, layer)
    exchanged = _received(network, solution)[order]
    warmth = solution.temperature + packing.centers @ solution.mean_gradient
    flux = mean_flux(network, scene, solution)
    return GrainField(
        packing, load, pairs, held, warmth, exchanged, solution.wall_heat, flux, network, solution.stats | spent
    )


def _conductivities(packing, solid):
    """One conductivity for each grain."""
    valid = f"a number > 0 W/(m K), or {packing.number} of them, one for each grain"
    k = reals("solid", solid, valid)
    if k.shape not in ((), (packing.number,)):
        raise ValueError(f"solid of shape {k.shape}: must be {valid}")
    for extreme in (k.min(), k.max()):
        check_conductivity("solid", float(extreme))
    return np.broadcast_to(k, packing.number)


def _load(packing, walls, gradient):
    """The load as a Scene: a void, 0, filled with what conducts by its links alone, 1."""
    if packing.domain != "box":
        raise NotImplementedError(f"packing.domain = {packing.domain!r}: grains are known in a box only")
    if (walls is None) == (gradient is None):
        raise ValueError(f"walls = {walls!r}, gradient = {gradient!r}: must be one of them")
    filled_with = Layer(0, 0.0, float(packing.size[0]), Material(1.0))
    scene = Scene(tuple(packing.size), Material(0.0), [filled_with], gradient=gradient, walls=walls)
    if scene.periodic:
        across = np.flatnonzero((np.array(scene.gradient) != 0) & ~packing.periodic)
        if len(across):
            raise ValueError(
                f"gradient = {gradient!r}: must be 0 along {'xyz'[across[0]]}, where the packing has walls"
            )
        return scene
    wrong = [name for name in scene.walls if name not in walls_of(packing)]
    if wrong:
        there = ", ".join(walls_of(packing))
        valid = (
            f"must be among {there}" if there else "must be a gradient instead, as the packing is periodic all round"
        )
        raise ValueError(f"walls = {dict(scene.walls)}: {valid}")
    if set(scene.wall_temperatures) < set(scene.walls) or any(map(callable, scene.walls.values())):
        raise NotImplementedError(f"walls = {dict(scene.walls)}: grains know walls with constant temperatures only")
    return scene


def _check_layer(packing, layer, sides):
    if not sides:
        raise ValueError(f"layer = {layer!r}: must be left out where no wall has a temperature")
    half = float(min(packing.size["xyz".index(name[0])] for name in sides)) / 2
    finite("layer", layer, f"a number > 0 m, below half of the box, {half:.6g}", lambda v: 0 < v < half)


def _check_reached(packing, held, sides):
    """A wall that no grain is near would insulate: what stands in a box too high for it is no zero conductivity."""
    for name in sides:
        if not np.any(held.conductance[held.side == SIDES.index(name)] > 0):
            away = float((wall_distance(packing, name) - packing.radii).min())
            raise ValueError(
                f"walls[{name!r}]: no grain exchanges heat with it, the nearest surface is {away:.4g} m away; must be "
                "a wall of the bed: give a `gap`, a `layer`, or a packing in a box that fits it"
            )


def _network(packing, pairs, held):
    """The network of the pairs, and where in it each pair stands in the row of its first grain."""
    n, count = packing.number, len(pairs.first)
    rows, others = np.concatenate((pairs.first, pairs.second)), np.concatenate((pairs.second, pairs.first))
    order = np.lexsort((others, rows))
    place = np.empty(2 * count, dtype=np.int64)
    place[order] = np.arange(2 * count)
    indptr = np.concatenate(([0], np.cumsum(np.bincount(rows, minlength=n)))).astype(np.int64)
    none = np.zeros(0)
    grain, side, distance, _, *parts = held or (none.astype(int), none.astype(int), *[none] * 4)
    network = Network(
        centers=packing.centers,
        size=packing.size,
        indptr=indptr,
        indices=others[order].astype(np.uint32),
        image=np.concatenate((pairs.image, 26 - pairs.image))[order].astype(np.uint8),
        conductance=np.tile(pairs.conductance, 2)[order],
        wall_particle=grain,
        wall_side=side,
        wall_conductance=parts[0] + parts[1],
        wall_area=np.pi * packing.radii[grain] ** 2,
        wall_distance=distance,
        volumes=4.0 / 3.0 * np.pi * packing.radii**3,
        phase=np.ones(n, dtype=int),
        radii=packing.radii,
        periodic=packing.periodic,
        cells=False,
        stats={"packing": packing.provenance},
    )
    return network, place[:count]


def _received(network, solution):
    """Heat that the row's grain receives through each link, (2 m,) float array, W."""
    warmth, rows = filled(solution), row_numbers(network.indptr)
    links = network.indptr, network.indices, network.image
    rise = warmth[network.indices] - warmth[rows]
    rise = rise + branches(network.centers, network.size, *links) @ solution.mean_gradient
    return network.conductance * rise
