"""Steady conduction by finite elements."""

import warnings
from functools import partial

import numpy as np

from demheat.field import Field
from demheat.runtime.deadline import budget
from demheat.runtime.process_state import one_blas_thread
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import finite, whole
from demheat.scene.narrows import narrows
from demheat.scene.volumes import known_fractions
from demheat.tensor import axis_loads
from references.fem.estimate import estimated, extrapolated
from references.fem.good import check_perfect
from references.fem.image import solved_image
from references.fem.lookup import NodalField
from references.fem.system import solve_loads
from references.mesh import make, split
from references.mesh.sizes import checked_size

# Contrast up to which the flux is never off by more than the tolerance shows, and by how much it may be beyond: found
# are 7e-4 in a sphere of 1e13 and, with the usual tolerance, beside a layer of 1e-8; any number in a sphere of 1e16.
ROUNDED, APART = 1e6, 1e-3
# Linear elements beside gaps of less than so many edges, where the radius is less than so many: edges wanted there are
# half of sqrt(gap radius), about one across the gap. A sphere between walls or its images was found 4 to 9 % off at
# contrasts of 30 and 1000 by edges over a fifth of the radius, by a seventh at most 3.3 %; at 10 and .001 up to 4 %.
GAP, FINE, STRONG = 2.0, 6.0, 12.0
# Part of its volume that a body of a function may lack: a quarter was found where an interval just missed.
LOST = 0.1


def solve(
    scene: Scene,
    *,
    order: int = 2,
    size: float | None = None,
    curved: bool = True,
    tolerance: float = 1e-9,
    seconds: float | None = None,
) -> Field:
    """Solve a scene by finite elements.

    Parameters
    ----------
    scene : Scene
        Spheres and layers, whose surfaces may resist, walls with temperatures, fluxes, convection and radiation or a
        periodic cell; conductivity 0 is a pore, infinity a perfect conductor. Or an image, whose voxels are the
        elements, trilinear hexahedra; `order` and `curved` are of tetrahedra, and `size` below a voxel splits voxels.
    order : {1, 2}
        Linear elements (always straight) or quadratic ones.
    size : float, m, optional
        Longest wanted edge; it is less on small spheres, in thin layers and in narrow gaps. Default: the cube root
        of the box volume over 26 (order 2) or 50 (order 1), about 1e5 unknowns; with many spheres an eighth of their
        mean distance.
    curved : bool
        Quadratic elements that follow the spheres; straight ones lose volume there.
    tolerance : float
        Largest relative residual of the equations, scaled to a unit diagonal.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Field
        `wall_heat` comes from the reactions at the nodes, `mean_flux` is the volume average. On an edge where two
        isothermal walls meet, nodes take the mean temperature and the walls share the heat; a flux enters a wall
        only where that conducts.

    Raises
    ------
    ValueError
        If an argument is not as described, the load leaves the temperature open, heat is forced where nothing takes it,
        or perfect conductors join two temperatures.
    NotImplementedError
        If surfaces of the scene touch, or resist beside pores.
    RuntimeError
        If meshing fails, the residual stays above the tolerance, or rounding drowns the flux at a contrast that is far
        too high.
    ImportError
        If gmsh or a system library that it needs is missing.

    Warns
    -----
    UserWarning
        If linear elements are few across a gap between good conductors, or elements have a tenth less or more volume
        than a body of a function.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import fem
    >>> print(f"{fem.solve(gallery.sphere_in_cube(5.0), size=0.012).conductivity:.2f}")  # exactly 42.640
    42.66
    """
    with budget(seconds):
        check_scene(scene)
        return _solved([scene], order, size, curved, tolerance)[0]


def solve_axes(
    scene: Scene,
    *,
    order: int = 2,
    size: float | None = None,
    curved: bool = True,
    tolerance: float = 1e-9,
    seconds: float | None = None,
) -> tuple[Field, Field, Field]:
    """Solve a scene by finite elements for loads along x, y and z: on one mesh, with one matrix where there is no pore.

    The fields are those that `solve` finds for the scenes of `demheat.tensor.axis_loads`; multigrid is set up once in
    a periodic cell, and between walls for each load, which holds other nodes.
    """
    with budget(seconds):
        return tuple(_solved(axis_loads(scene), order, size, curved, tolerance))


def _solved(scenes, order, size, curved, tolerance):
    """The Field of each of some scenes that differ in their loads only."""
    finite("tolerance", tolerance, "a number between 0 and 1", lambda v: 0 < v < 1)
    for scene in scenes:
        text = "beside interfaces with a resistance finite elements take no pores"
        takes = ("resistance", "exchange", "anisotropy", "dependence", "image", "perfect")
        scene.require(text, steady=True, pores=not scene.resistances.any(), takes=takes)
        if scene.image is not None:
            scene.require("bricks of an image know one number for each phase", takes=("exchange", "image"))
        check_perfect(scene)
        if scene.radiates:
            scene.require("finite elements iterate for it or for walls that radiate", takes=(*takes[:3], "image"))
        if scene.image is None and order == 1 and scene.domain == "box":
            warn_of_gaps(scene, checked_size(scene, size, order))
    if scenes[0].image is not None:
        whole("order", order, "1 or 2", lambda v: v in (1, 2))
        return one_blas_thread()(solved_image)(scenes, size, tolerance)
    return _answers(scenes, tolerance, size=size, order=order, curved=curved)


def warn_of_gaps(scene, size) -> None:
    """Linear elements are stiff, a straight drop of temperature each: a gap needs some across."""
    k, parents = scene.mean_conductivities, scene.parents()[1:]
    near = narrows(scene, GAP * size, STRONG) & (k[1:] > k[0]) & (k[0] > 0) & (parents == 0)
    # Layers have no end; larger spheres have elements of their own size all round.
    near = [n for n in np.flatnonzero(near).tolist() if FINE * size > scene.inclusions[n].ball()[1]]
    if near:
        warnings.warn(
            f"gaps beside inclusions {near[:8]}{' and more' if len(near) > 8 else ''} have an element or so across at "
            f"edges of {size:.3g} m: linear ones may be off by a tenth; use smaller ones or order=2",
            stacklevel=4,
        )


def _warn_of_lost(scene, mesh) -> None:
    """Elements that a surface of a function cuts off coarsely have another volume than its body."""
    asked = np.array([False] + [shape.finding == "function" for shape in scene.inclusions])
    if not asked.any():
        return
    right = known_fractions(scene)
    off = np.abs(np.bincount(mesh.phase, mesh.volumes, len(right)) / scene.volume - right)
    lost = np.flatnonzero(asked & (off > LOST * right))
    if len(lost):
        worst = lost[np.argmax(off[lost] / right[lost])]
        warnings.warn(
            f"inclusion {worst - 1}: its elements have another volume than it has by {off[worst] / right[worst]:.0%}: "
            "the conductivity may be off by as much of what it changes; use smaller ones",
            stacklevel=5,
        )


def _answers(scenes, tolerance, **elements):
    """Solve on one mesh; `elements` are knobs of `references.mesh.make`."""
    mesh = split(scenes[0], make(scenes[0], **elements))
    _warn_of_lost(scenes[0], mesh)
    # The order of BLAS's sums, and so the last bits, is that of its threads; here more of them gain nothing.
    solved = one_blas_thread()(solve_loads)(scenes, mesh, tolerance)
    kind = "linear" if elements["order"] == 1 else "curved" if elements["curved"] else "straight"
    fields = []
    for scene, each in zip(scenes, solved, strict=True):
        how = {"again": partial(_again, scene, tolerance, elements), "kind": kind}
        told = partial(estimated, **how), partial(extrapolated, **how)
        fields.append(field_of(scene, mesh, each, tolerance, *told))
    return fields


def _again(scene, tolerance, elements, **changed):
    """The same by other elements, of the same length if nothing else is said."""
    size = checked_size(scene, elements["size"], elements["order"])
    return _answers([scene], tolerance, **elements | {"size": size} | changed)[0]


def field_of(scene, mesh, solved, tolerance, estimator, extrapolator=None) -> Field:
    """The Field of nodal temperatures."""
    alone = one_blas_thread()
    solution = NodalField(solved.shown or scene, mesh, solved.temperature, **_cut_off(scene, solved.bodies))
    mean_flux = alone(solution.mean_flux)()
    alone(_check_rounding)(solution, mean_flux, solved.wall_temperature, tolerance)
    fractions = np.bincount(mesh.phase, mesh.volumes, len(scene.materials)) / scene.volume
    stats = {"elements": len(mesh.cells), "nodes": len(mesh.points)} | mesh.stats | solved.stats
    return Field(
        scene=scene,
        mean_flux=mean_flux,
        fractions=fractions,
        sampler=alone(solution.samples),
        temperature_at=alone(solution.temperature_at),
        flux_at=alone(solution.flux_at),
        wall_temperature=solved.wall_temperature,
        wall_heat=solved.wall_heat,
        stats=stats,
        estimator=estimator,
        extrapolator=extrapolator,
        elements=lambda: (mesh.points, mesh.cells),
    )


def _check_rounding(solution, mean_flux, wall_temperature, tolerance):
    """Raise RuntimeError if the mean flux is another than the power says, which rounding hardly touches.

    The power is a sum of squares. In a good conductor the flux is a large number times what is left of temperatures
    that hardly differ; where that is rounding, or what the tolerance leaves, it is any number.
    """
    scene = solution.scene
    k = scene.mean_conductivities
    conducting = k[k > 0]
    if not len(conducting) or conducting.max() <= ROUNDED * conducting.min():
        return
    if scene.periodic:
        worked = -float(np.array(scene.gradient) @ mean_flux)
    elif len(scene.walls) == 2 and len({name[0] for name in scene.walls}) == 1 and not scene.wall_exchanges:
        one, other = wall_temperature.values()
        worked = abs(float(mean_flux[scene.axis])) * abs(one - other) / scene.size[scene.axis]
    else:
        return
    power = solution.power() / scene.volume
    if not abs(worked - power) <= (APART + 10 * tolerance) * power:
        raise RuntimeError(
            f"fem.solve: the flux is off by {abs(worked / power - 1):.1e} of itself, by its power: at a contrast of "
            f"{conducting.max() / conducting.min():.1e} rounding, and what the tolerance of {tolerance:.1e} leaves, "
            "are seen; must be a smaller tolerance, a lower contrast, or 0 for what hardly conducts"
        )


def _cut_off(scene, bodies):
    """Elements that no heat passes, and those of bodies that no temperature reaches."""
    if bodies is None:
        return {}
    is_open = np.append(~bodies.passing & np.isnan(bodies.level), False)[bodies.element]
    return {"still": bodies.still, "open": None if scene.periodic else is_open}
