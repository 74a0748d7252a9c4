"""One scene by one method: its answer and the interval that it gives by itself; or what is known of it."""

from functools import partial

import numpy as np

from demheat import gate
from demheat.scene import Ellipsoid
from demheat.scene.negligible import change_without
from demheat.scene.volumes import known_fractions
from references.mesh.sizes import check_cost, wanted_sizes
from studies.common.answers import answer
from studies.harness import methods
from studies.intervals.scenes import scene_of

# What is spent, drawn by the scene's seed: particles, voxels and elements along the edge of a cube as large as the box.
PARTICLES, VOXELS, ELEMENTS = (3000, 8000), (32, 48), (5.0, 8.0)
# And the accuracy that multipoles of unlike spheres are asked for.
ROUGH = (1e-2, 2e-4)
# Beyond which the FFT refuses; by Eyre and Milton's scheme they grow with the root of the contrast.
ITERATIONS = {"fft": 1000, "fft-em": 300}
KNOBS = {"fft": {"scheme": "cg"}, "fft-em": {"scheme": "eyre-milton"}}
# Tetrahedra expected beyond which finite elements are not asked: thin layers and coats take squares of them.
MOST = 12_000
# The DEM neither, where the axes of an ellipsoid differ more: both follow how sharply a surface is bent.
SLENDER = 5.0
# Of bounds that intervals must reach.
ROUNDING = 1e-12


def known(kind: str, seed: int) -> dict:
    """What is true of a scene's conductivity, W/(m K), and by whom; nothing where the dual alone tells."""
    found = scene_of(kind, seed).known
    return {"true_source": "Keller"} if found is None else {f"true_{k}": v for k, v in found()._asdict().items()}


def judged(kind: str, seed: int, method: str) -> dict:
    """A method's answer and interval, what it warned of, and whether parts that it does not see are counted."""
    drawn = scene_of(kind, seed)
    solve = partial(_solve, method, share=float(np.random.default_rng([seed, 1]).random()), seed=seed)
    field, said, refusal = answer(lambda: solve(drawn.scene))
    if refusal is not None:
        return {"status": "unsupported", "note": " ".join(str(refusal).split())}
    error, more, none = answer(lambda: field.error)
    row = {"conductivity": field.conductivity, "warned": bool(said or more), "warning": "; ".join([*said, *more])[:120]}
    row["unseen"] = bool(_lost(field).any())
    if none is not None:
        return row | {"remark": " ".join(str(none).split())}
    row |= {"lower": error.lower, "upper": error.upper}
    if row["unseen"]:
        row["reached"] = _reached(field, error)
    if drawn.dual is not None:
        _, _, refusal = other = answer(lambda: solve(drawn.dual).error)
        if refusal is None:
            row |= {"dual_lower": 1 / other[0].upper, "dual_upper": 1 / other[0].lower if other[0].lower else np.inf}
    return row


def limited(kind: str, seed: int, method: str) -> dict:
    """What a method's answers close in on, with the interval of that, beside the answer."""
    share = float(np.random.default_rng([seed, 1]).random())
    field, _, refusal = answer(lambda: _solve(method, scene_of(kind, seed).scene, share=share, seed=seed))
    limit, _, none = (None, (), refusal) if refusal is not None else answer(lambda: field.extrapolated)
    if none is not None:
        return {"status": "unsupported", "note": " ".join(str(none).split())}
    row = {"conductivity": limit.conductivity, "plain": field.conductivity, "order": limit.order}
    return row | {"lower": limit.lower, "upper": limit.upper, "warned": False, "unseen": False}


def _solve(method, scene, *, share, seed):
    """By its defaults but for what it spends and the iterations after which it refuses."""
    module = methods.load(method.split("-")[0])
    edge = scene.volume ** (1 / 3)
    axes = [each.semi_axes for each in scene.inclusions if isinstance(each, Ellipsoid)]
    if method in ("dem", "fem") and any(max(each) > SLENDER * min(each) for each in axes):
        raise NotImplementedError(f"twins or tetrahedra on an ellipsoid over 1:{SLENDER:g} are dear: not asked")
    if method == "dem":
        return module.solve(scene, particles=_between(PARTICLES, share), seed=seed)
    if method == "fem":
        return module.solve(scene, **({} if scene.image else {"size": _size(scene, edge, share)}))
    if method == "multipole":
        # The default where closed forms judge, else as rough that finer ones can.
        alike = len({each.radius for each in scene.inclusions}) == 1
        return module.solve(scene, accuracy=None if alike else ROUGH[0] * (ROUGH[1] / ROUGH[0]) ** share)
    along = _between(VOXELS, share) / edge
    more = {} if scene.image else {"voxels": [max(1, round(side * along)) for side in scene.size]}
    return module.solve(scene, max_iterations=ITERATIONS[method], threads=1, **KNOBS[method], **more)


def _size(scene, edge, share):
    """Longest edge, m, where a mesh is not dear."""
    size = edge / (ELEMENTS[0] * (ELEMENTS[1] / ELEMENTS[0]) ** share)
    if check_cost(wanted_sizes(scene, size), scene.size, 2) > MOST:
        raise NotImplementedError(f"a mesh of over {MOST} tetrahedra is expected: not asked")
    return size


def _between(ends, share):
    return round(ends[0] * (ends[1] / ends[0]) ** share)


def _lost(field):
    """Phases that a method cannot see, though they conduct otherwise than what they lie in.

    It holds nothing of them, or they are smaller than one of its voxels or particles.
    """
    scene, stats = field.scene, field.stats
    k = scene.conductivities
    lost = field.fractions == 0
    if scene.inclusions and ("voxels" in stats or "packing" in stats):
        element = (scene.volume / np.prod(stats.get("voxels", stats["unknowns"]))) ** (1 / 3)
        lost[1:] |= [not each.flat and max(np.subtract(*each.bounds()[::-1])) < element for each in scene.inclusions]
    return lost & (known_fractions(scene) > 0) & (k != k[gate.parents_of(scene)])


def _reached(field, error):
    """Whether an interval goes to the bounds of the body's own fractions, or as far as what is lost could change it."""
    scene, k = field.scene, field.conductivity
    bounds = (gate.hashin_shtrikman if gate.isotropic(scene) else gate.wiener)(scene, known_fractions(scene))
    most = k * change_without(scene, np.flatnonzero(_lost(field)[1:]))
    low, high = max(bounds.lower, k - most), min(bounds.upper, k + most)
    return bool(error.lower <= low + ROUNDING * k and error.upper >= high - ROUNDING * k)
