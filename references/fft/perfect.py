"""Perfect conductors on voxels: as conductors `GOOD` times as good as the rest, where these are apart and do not span.

That is a large number, not one unknown for each body: iterations go with its logarithm, five times as many as at a
contrast of 100. What it lacks of infinity, 1e-8, is below what voxels lack.
"""

import numpy as np

from demheat.scene import Scene
from demheat.scene.perfect import INFINITE, contacts
from demheat.scene.resistances import joined
from demheat.scene.shapes.base import TOUCH
from references.voxels.bodies import gathered

# Steps from either voxel's centre to where a line between them leaves a body: faces are met in the first rounds.
STEPS = 50
# Of a line's length: steps below are none.
SETTLED = 1e-9


def check_perfect(scene: Scene, scheme: str, precision: str) -> None:
    """Raise unless perfect conductors of a scene are known to a scheme."""
    if not scene.perfect:
        return
    touching = contacts(scene)
    if scheme == "eyre-milton":
        scene.require(
            "Eyre and Milton's scheme converges like the square root of the contrast, which is infinite; use scheme "
            "'cg'",
            takes=("resistance",),
        )
    text = "on voxels what is beside perfect conductors conducts alike all round"
    scene.require(text, takes=("resistance", "exchange", "perfect"))
    if precision != "float64":
        raise NotImplementedError(
            f"precision = {precision!r} has too few digits beside perfect conductors: must be 'float64'"
        )
    if touching:
        raise NotImplementedError(
            f"perfect spheres touch, {_named(touching[0][0] + 1)} among them: voxels see a gap; must be apart, or "
            "resist"
        )


def check_rule(scene: Scene, perfect, rule: str) -> None:
    """Raise NotImplementedError for laminates of perfect conductors with round surfaces that do not resist."""
    if rule != "laminate":
        return
    open_ = scene.resistances == 0
    round_ = np.array([False] + [not shape.flat for shape in scene.inclusions])
    sides = perfect != perfect[scene.parents()]
    if np.any(round_ & open_ & sides):
        raise NotImplementedError(
            f"rule = {rule!r}: laminates of voxels that a perfect conductor cuts are a tenth off on 32 voxels along an "
            "edge; must be 'links' or 'plain', or its surface must resist"
        )


def check_spans(scene: Scene, perfect, phase, slope) -> None:
    """Raise if perfect phases of a grid join two temperatures, or if it is too coarse to tell."""
    inside, sides, slope = perfect[phase], joined(scene), np.asarray(slope)
    below = []
    for axis in range(3):
        other = np.roll(phase, 1, axis)
        both = inside & perfect[other] & (sides[phase] == sides[other])
        if not scene.periodic:
            both[(slice(None),) * axis + (0,)] = False
        _check_apart(scene, np.unique(np.stack([phase[both], other[both]]), axis=1).T)
        below.append(both)
    if not _spans(scene, phase, inside, below, slope):
        return
    parted = _part(scene, perfect, phase, below)
    if _spans(scene, phase, inside, below, slope):
        raise ValueError(INFINITE)
    raise NotImplementedError(
        f"voxels do not see what parts perfect conductors, {_named(parted)} among them: what lies between must be as "
        "wide as a voxel, its surface must resist, or there must be more voxels"
    )


def _spans(scene, phase, inside, below, slope):
    """Whether voxels that open faces below them join reach from wall to wall, or up the mean gradient."""
    found, count = gathered(inside, tuple(below), scene.periodic, slope * scene.size)
    if scene.periodic:
        return found.climbs[:count].any()
    ends = [found.label[end][inside[end] & _reaching(scene, phase[end], end)] for end in (0, -1)]
    return slope[0] and len(np.intersect1d(*ends))


def _part(scene, perfect, phase, below):
    """Shut faces across which a line between two centres leaves its body; return the phase of one such, if any."""
    parents, parted = scene.parents(), None
    spacing = np.array(scene.size) / phase.shape
    for axis, open_ in enumerate(below):
        at = np.argwhere(open_)
        upper, own = (at + 0.5) * spacing, phase[open_]
        for number, shape in enumerate(scene.inclusions, start=1):
            # Out of a perfect body, or into what lies in one and is none itself.
            of, sign = (number, 1.0) if perfect[number] else (int(parents[number]), -1.0)
            mine = np.flatnonzero(own == of)
            mine = mine[_leaves(scene, shape, upper[mine], axis, spacing[axis], sign)]
            open_[tuple(at[mine].T)] = False
            parted = of if len(mine) else parted
    return parted


def _leaves(scene, shape, upper, axis, length, sign):
    """Which lines of a length down an axis from points leave a shape, or with sign -1 enter it."""
    size, leaves = scene.size, np.zeros(len(upper), bool)

    def outside(points):
        return sign * shape.distance(points, period=scene.period)

    # Farther inside than the line is long nothing can leave.
    near = np.flatnonzero(outside(upper) > -length) if len(upper) else []
    if not len(near):
        return leaves
    high, low = upper[near], upper[near]
    low[:, axis] -= length
    going = np.arange(len(near))
    for _ in range(STEPS):
        down, up = (np.maximum(-outside(each[going]), 0.0) for each in (high, low))
        high[going, axis] -= down
        low[going, axis] += up
        # What has passed each other, or stands at the surface, goes no farther.
        going = going[(high > low)[going, axis] & (np.maximum(down, up) > SETTLED * length)]
        if not len(going):
            break
    # Where both have passed each other nothing is between them.
    leaves[near] = (high > low)[:, axis] & (outside(0.5 * (high + low)) > TOUCH * max(size))
    return leaves


def _check_apart(scene, pairs):
    parents = scene.parents()
    for one, two in np.sort(pairs, axis=1).tolist():
        if one != two and parents[two] != one:
            raise NotImplementedError(
                f"perfect conductors {_named(one)} and {_named(two)} touch, or their gap is thinner than a voxel: must "
                "be apart, resist, or be more voxels"
            )


def _reaching(scene, phase, end):
    """Where perfect phases of a plane of voxels at a wall across x meet it."""
    meets = np.zeros(len(scene.materials), bool)
    meets[0] = True
    for number, shape in enumerate(scene.inclusions, start=1):
        low, high = (each[0] for each in shape.bounds())
        gap = low if end == 0 else scene.size[0] - high
        meets[number] = gap <= TOUCH * scene.size[0]
    return meets[phase]


def _named(phase):
    return f"Scene.inclusions[{phase - 1}]" if phase else "Scene.matrix"
