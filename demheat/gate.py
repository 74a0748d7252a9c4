"""What every answer passes: no conductivity beyond what any body with these fractions of its materials can have.

A method divides a body into elements, and knows by them how much there is of each material. The arithmetic and the
harmonic mean over those fractions (Wiener's bounds) hold for whatever it solves on them: of a mean gradient or flux the
temperature that is linear, or the flux that is uniform, is one of those among which the true one has the least energy.
Where turns of the body take all axes to each other the narrower bounds of Hashin and Shtrikman hold. Both are widened
by what elements of that size may not see: half of one on either side of every surface. What lies beyond is wrong,
whatever the reason, and so are fractions that differ by more than that from the body's own. Beside perfect conductors
the upper bounds are infinite.
"""

import math
from typing import NamedTuple

import numpy as np

from demheat.scene.symmetry import alike_axes
from demheat.scene.volumes import fractions, sampled_fractions

# Sums of as many numbers as there are unknowns, and iterations that stop at a residual: of the conductivity.
ROUNDING, RESIDUAL = 1e-6, 10.0
# Of the upper bound: rounding of what is none.
NOTHING = 1e-12
# What fractions by sampling may be off: twice the most that was found of 300 spheres and as many layers.
NOISE = 0.02
# Inclusions up to which symmetries are looked for: beyond them that costs more than what it might find is worth.
FEW = 8
HELP = "use more or smaller elements (particles, voxels, a finer mesh), or another rule, law or method"


class Bounds(NamedTuple):
    """Between which a conductivity lies, W/(m K), and whose they are."""

    lower: float
    upper: float
    name: str


def check_answer(field) -> None:
    """Raise RuntimeError if a steady field's conductivity or fractions cannot be right."""
    if field.time is not None or not field.stats:
        return
    try:
        k = field.conductivity
    except (ValueError, KeyError):
        return
    check_conductivity(field.scene, k, field.fractions, field.stats, field.slack)
    _check_fractions(field)


def check_conductivity(scene, k, fractions, stats, slack=(0.0, 0.0)) -> None:
    """Raise RuntimeError if a conductivity is none that a body with these fractions can have."""
    own = ROUNDING + RESIDUAL * stats.get("residual", 0.0)
    more = slack[0] + own, slack[1] + own
    for bounds_of, holds in ((wiener, None), (hashin_shtrikman, isotropic)):
        bounds = bounds_of(scene, fractions)
        # Symmetries, and what elements may not see, are looked for only where that matters.
        if _within(k, bounds, more) or (holds and not holds(scene)):
            continue
        wide = bounds_of(scene, fractions, unseen(scene, stats))
        if not _within(k, wide, more):
            raise RuntimeError(
                f"no answer: the conductivity found, {k:.6g} W/(m K), lies beyond {bounds.name} bounds, "
                f"{bounds.lower:.6g} to {bounds.upper:.6g} W/(m K), of bodies that hold as much of each material as "
                f"these elements see, by more than their size explains ({wide.lower:.6g} to {wide.upper:.6g}); {HELP}"
            )


def check_tensor(scene, tensor, own, stats, slack=(0.0, 0.0)) -> None:
    """Raise RuntimeError if an eigenvalue of a conductivity tensor is one that no body of these fractions can have."""
    for k in () if scene.anisotropic else np.linalg.eigvalsh(0.5 * (tensor + tensor.T)):
        check_conductivity(scene, float(k), own, stats, slack)


def check_bracket(scene, lower, upper) -> None:
    """Raise RuntimeError if what should be bounds of a scene's conductivity cannot both be."""
    try:
        body = scene.image.fractions if scene.image is not None else fractions(scene)
    except NotImplementedError:
        return
    for bounds in (wiener(scene, body), *([hashin_shtrikman(scene, body)] if isotropic(scene) else [])):
        if lower > min(upper, bounds.upper) * (1 + ROUNDING) or upper < bounds.lower * (1 - ROUNDING):
            raise RuntimeError(
                f"no answer: {lower:.6g} to {upper:.6g} W/(m K), found as bounds, and {bounds.name}, "
                f"{bounds.lower:.6g} to {bounds.upper:.6g} W/(m K), have nothing in common"
            )


def _within(k, bounds, more):
    least = bounds.lower * (1 - more[0]) if more[0] < 1 else 0.0
    # Not a number where no wall has a temperature: pores all over.
    most = bounds.upper if math.isfinite(bounds.upper) else abs(k)
    return not (k < least - NOTHING * most or k > bounds.upper * (1 + more[1]))


def wiener(scene, fractions, moved=None) -> Bounds:
    """Wiener's bounds of the conductivity along a scene's load.

    They hold in periodic cells and between two opposite walls, held or not: where surroundings exchange heat or a flux
    enters, what the walls' temperatures and fluxes differ from their means is of the sign that makes them so.
    """
    along, across = conductances(scene)
    with np.errstate(divide="ignore", invalid="ignore"):
        resist = 1.0 / across
        upper = fractions[fractions > 0] @ along[fractions > 0]
        blocked = np.any((across == 0) & (fractions > 0)) or scene.resistances.any()
        lower = 0.0 if blocked else 1.0 / (fractions[across > 0] @ resist[across > 0])
        if moved is not None:
            parents = parents_of(scene)
            # One perfect conductor on another changes nothing.
            upper += np.nansum(moved * np.abs(along - along[parents]))
            lower = 0.0 if not lower else 1.0 / (1.0 / lower + np.nansum(moved * np.abs(resist - resist[parents])))
    return Bounds(float(lower), float(upper), "Wiener's")


def isotropic(scene) -> bool:
    """Whether a body has few inclusions and conducts alike along x, y and z, between held walls, by its symmetry."""
    plain = scene.image is None and not (scene.anisotropic or scene.varies or scene.resistances.any())
    plain = plain and 0 < len(scene.inclusions) <= FEW and not any(shape.flat for shape in scene.inclusions)
    return plain and (scene.periodic or len(scene.wall_temperatures) == 2) and alike_axes(scene) == (0, 0, 0)


def hashin_shtrikman(scene, fractions, moved=None) -> Bounds:
    """Hashin and Shtrikman's bounds, of bodies that are `isotropic`."""
    k = scene.mean_conductivities
    parents = None if moved is None else parents_of(scene)
    if not np.any(k[fractions > 0]):
        return Bounds(0.0, 0.0, "Hashin and Shtrikman's")
    ends = []
    for other in (k.min(), k.max()):
        with np.errstate(divide="ignore"):
            part = 1.0 / (k + 2 * other)
        total = fractions @ part if other else math.inf
        if moved is not None and other:
            total -= (1 if other == k.max() else -1) * float(moved @ np.abs(part - part[parents]))
        # Fractions that may be that far off say nothing of the upper one.
        ends.append(1.0 / total - 2 * other if total > 0 else float(k.max()))
    return Bounds(max(ends[0], 0.0), min(ends[1], float(k.max())), "Hashin and Shtrikman's")


def conductances(scene) -> tuple[np.ndarray, np.ndarray]:
    """Of each phase, largest along the load, and least that resists across it, two (phases,) float arrays, W/(m K)."""
    if not scene.anisotropic:
        k = scene.mean_conductivities
        return (k, k) if not scene.varies else _at_temperatures(scene, k)
    load = np.array(scene.gradient) if scene.periodic else np.eye(3)[scene.axis]
    load = load / np.linalg.norm(load)
    tensors = scene.tensors
    solid = tensors.any(axis=(1, 2))
    across = np.zeros(len(tensors))
    across[solid] = 1.0 / np.einsum("i,kij,j->k", load, np.linalg.inv(tensors[solid]), load)
    return np.einsum("i,kij,j->k", load, tensors, load), across


def _at_temperatures(scene, k):
    """Where conductivities follow the temperature: the largest and the least.

    Temperatures lie between those imposed; where a flux is, anywhere.
    """
    ends = [-np.inf, np.inf] if scene.wall_fluxes else list(scene.imposed_temperatures.values())
    most, least = np.ones(len(k)), np.ones(len(k))
    for number, material in enumerate(scene.materials):
        if material.dependence is not None:
            inner = [t for t, _ in material.dependence.points if min(ends) < t < max(ends)]
            factors = material.dependence.factor(np.array(ends + inner))
            most[number], least[number] = factors.max(), factors.min()
    return k * most, k * least


def parents_of(scene) -> np.ndarray:
    """Phase that each was painted on; of an image the worst conductor beside the best, which any may border on."""
    if scene.image is None:
        return scene.parents()
    k = scene.mean_conductivities
    return np.where(k > np.median(k), np.argmin(k), np.argmax(k))


def unseen(scene, stats) -> np.ndarray:
    """By how much the fraction of each phase may be off: half an element at its surface, (phases,) float array."""
    if scene.image is not None:
        # Surfaces all over: as much as elements thrown at it at random would miss.
        return np.full(len(scene.materials), 1.0 / math.sqrt(stats.get("unknowns", math.inf)))
    if "voxels" in stats:
        length = float(np.max(np.array(scene.size) / stats["voxels"]))
    else:
        length = (scene.volume / stats["unknowns"]) ** (1 / 3) if stats.get("unknowns") else 0.0
    # Of the faces of the bounds, an element at least, and no more than all within them, or an element.
    size = np.array(scene.size)
    spans = [np.minimum(high - low, size) for low, high in (shape.bounds() for shape in scene.inclusions)]
    x, y, z = np.array(spans).reshape(-1, 3).T
    moved = np.clip(length * (x * y + y * z + z * x), length**3, np.maximum(x * y * z, length**3))
    return np.concatenate([[0.0], moved / scene.volume])


def _check_fractions(field):
    """Compare materials that conduct alike as one: of many small inclusions each is but a few points."""
    scene = field.scene
    if len(field.fractions) < 2:
        return
    body = scene.image.fractions if scene.image is not None else sampled_fractions(scene)
    kinds, kind = np.unique(scene.mean_conductivities, return_inverse=True)
    off = np.bincount(kind, field.fractions - body, len(kinds))
    if np.all(np.abs(off) <= NOISE):
        return
    moved = unseen(scene, field.stats)
    may = np.bincount(kind, moved) + np.bincount(kind[parents_of(scene)], moved, len(kinds)) + NOISE + max(field.slack)
    worst = int(np.argmax(np.abs(off) - may))
    if abs(off[worst]) > may[worst]:
        raise RuntimeError(
            f"no answer: of what conducts {kinds[worst]:.6g} W/(m K) these elements see {off[worst]:+.3g} of the "
            f"body's volume more than there is, and their size explains {may[worst]:.3g}: a surface is not where the "
            f"scene has it; {HELP}"
        )
