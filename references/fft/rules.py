"""Rules for voxels that an interface cuts: which one suits a scene, and what each does not see."""

import warnings

import numpy as np

from demheat.scene.narrows import narrows
from demheat.scene.volumes import coats, narrower
from references.voxels.kernels import FULL

# Errors of the scalar scheme in % at 128^3, measured on a sphere with the radius a third of the cube's edge, against
# log10 of its conductivity over the matrix's.  All rules are of first order in the voxel, so other grids choose alike.
MEASURED = {
    "decades": [-4, -3, -2, -1, 0, 1, 2, 3, 4],
    "plain": [0.13, 0.13, 0.12, 0.063, 0, 0.18, 0.42, 0.46, 0.45],
    "laminate": [0.32, 0.15, 0.036, 0.005, 0, 0.013, 0.13, 0.60, 1.58],
    "links": [0.37, 0.37, 0.34, 0.20, 0, 0.058, 0.017, 0.006, 0.005],
}
# What rules make of an inclusion smaller than a voxel.
MISSED = {
    "plain": "miss them or see whole voxels instead",
    "laminate": "see many times their effect at high contrast: a voxel has their volume, not their shape; it misses "
    "layers a billion times thinner",
    "links": "miss them or see some of them only",
}
# Voxels along a side below which gaps of up to two voxels are said, at contrasts from this on: at 7 voxels they were
# found to cost a sixth of the conductivity, at two a half.
FEW, WEAK = 10, 2.0
# So many times worse than the best conductor a coat thinner than a voxel leaks: a layer of no conductivity around a
# ball that nearly reaches through it let a twentieth to a tenth of the matrix's pass where nothing should.
LEAKING = 100.0
# Elsewhere gaps of so many voxels are said: of 1.04 voxels, at contrast 100, cost 23 %, of 1.4 13 %.
NEAR = 1.4
# Voxels along a side below which links are not for round bodies: of 128 spheres (radii .23 to .48 of the cell,
# contrasts .01 to 100, walls and periodic cells) 112, 92, 10 and 6 were beyond Voigt's or Reuss's bound with 1, 2, 3
# and 4 voxels, with more none.
LEAST_LINKED = 5
# Voxels across an inclusion below which coarser voxels do not tell what is missing.
FEWEST = 2.0


def automatic(scheme, scene, shape) -> str:
    """The rule with the smallest measured error for the worst of the scene's interfaces.

    Layers do not count: a laminate is exact for them, links are not where layers end between two nodes. What has no
    surface that is found has the phase of voxels' centres only, and an image cuts none. A side of fewer than
    `LEAST_LINKED` voxels has no links.
    """
    if scene.image is not None or not all(shape.traceable for shape in scene.inclusions):
        return "plain"
    if scheme == "eyre-milton" or scene.anisotropic or scene.resistances.any():
        return "laminate"
    conductivity = scene.conductivities
    rounded = np.array([True] + [not shape.flat for shape in scene.inclusions])
    inner, outer = conductivity[rounded][1:], conductivity[scene.parents()][rounded][1:]
    if not np.any(inner != outer):
        return "laminate"
    if conductivity.min() == 0:
        return "plain"
    decades = np.log10(inner / outer)
    worst = {
        rule: np.interp(decades, MEASURED["decades"], MEASURED[rule]).max() for rule in MEASURED if rule != "decades"
    }
    if min(shape) < LEAST_LINKED:
        del worst["links"]
    return min(worst, key=worst.get)


def warn_of_thin(scene, rule, shape) -> None:
    """Warn of what a rule does not see: a voxel that holds both faces of a coat has three materials, rules know two."""
    voxel, left = float(np.max(np.array(scene.size) / shape)), coats(scene)
    thin = np.flatnonzero(left < voxel)
    if len(thin):
        k = scene.mean_conductivities
        leaks = np.any(LEAKING * k[thin + 1] <= k.max())
        what = "heat leaks through and the conductivity may be off many times" if leaks else "errors may be percents"
        warnings.warn(
            f"inclusions {_listed(thin)} are coats thinner than a voxel of "
            f"{voxel:.3g} m, down to {left[thin].min():.3g} m: {what}; use more voxels",
            stacklevel=4,
        )
    small = smaller(scene, rule, shape)
    if len(small):
        warnings.warn(
            f"inclusions {_listed(small)} are smaller than a voxel of {voxel:.3g} m: rule {rule!r} may "
            f"{MISSED[rule]}; use more voxels",
            stacklevel=4,
        )
    _warn_of_gaps(scene, rule, shape, voxel)


def smaller(scene, rule, shape, voxels=1.0) -> np.ndarray:
    """Inclusions that are narrower than a voxel, or so many, and stand out: an int array."""
    spacing = voxels * np.array(scene.size) / shape
    # Laminates are exact for layers of any thickness that they see.
    small = narrower(scene, spacing) & [rule != "laminate" or not each.flat for each in scene.inclusions]
    small |= narrower(scene, FULL * spacing)
    k = scene.tensors if scene.anisotropic else scene.conductivities[:, None, None]
    return np.flatnonzero(small & np.any(k[1:] != k[scene.parents()[1:]], axis=(1, 2)))


def unsure(scene, rule, shape) -> np.ndarray:
    """Inclusions of which refinement tells too little: coats and parts not much wider than a voxel."""
    if not scene.inclusions:
        return np.empty(0, int)
    thin = np.flatnonzero(coats(scene) < np.max(np.array(scene.size) / shape))
    return np.union1d(thin, smaller(scene, rule, shape, FEWEST))


def _warn_of_gaps(scene, rule, shape, voxel):
    rounded = np.array([not each.flat for each in scene.inclusions], bool)
    near = narrows(scene, NEAR * voxel) & (rounded | (rule == "plain"))
    if min(shape) < FEW:
        near |= narrows(scene, 2 * voxel, WEAK) & rounded
    if near.any():
        warnings.warn(
            f"gaps beside inclusions {_listed(np.flatnonzero(near))} are not wide for voxels of {voxel:.3g} m: between "
            "good conductors, or bad ones, errors may be tens of percents; use more voxels",
            stacklevel=6,
        )


def _listed(numbers):
    return f"{numbers[:8].tolist()}{' and more' if len(numbers) > 8 else ''}"
