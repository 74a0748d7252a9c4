"""How far a solution on voxels is off, by larger voxels of the same scene."""

from itertools import combinations

import numpy as np

from demheat.error import Estimate, Fine, Refinement, by_refinement, conductivity_of
from demheat.extrapolation import Limit, by_extrapolation
from demheat.splitting import Splitting, by_splitting
from references.fft.edges import hidden
from references.fft.rules import unsure

# By rule.
RULES = {
    "plain": Refinement("larger voxels", 2**0.5, 1.0, 2.2, 1.0, chance=True),
    "laminate": Refinement("larger voxels", 2**0.5, 1.0, 1.2, 1.0),
    "links": Refinement("larger voxels", 2**0.5, 1.0, 1.5, 1.0),
}
# Between grids of some ten voxels across a body errors fall with the power 2 by either rule: .4 of them is left (even
# seeds). In the end they fall with the first, and about spheres near to each other with less on the way. Halves of a
# grid would see flat faces as it does.
LIMIT = Limit("larger voxels, extrapolated", 1.8, 2.0, 2.0, 1.5, last=0.75)
# Order of what surfaces that resist leave: one, but its factor is small and moves with their place in voxels.
FILMS = 0.5
# Of what edges within voxels hide, laminates miss so much at most: around cubes in the middle of a cell, whose edges
# all lie alike in voxels, errors are .4 to 1.04 of it (contrast 10, 24 to 128 voxels along an edge).
HIDDEN = 1.1
# As that part hangs on their place in voxels, what two grids show of it may be so many times too little: 1.8 times at
# 128 voxels along a cell with a cube of .4, 2.3 at 88.
ALIKE = 2.5
# Of images: 28 drawn ones (noise, Gaussian fields, spheres; contrasts .001 to 1000, pores) ask for up to 2.8.
SPLIT = Splitting(64**3, 3.0)
# Of Eyre and Milton's scheme: where four blocks meet as on a checkerboard errors fall with the power .25 at contrast
# 100 (study `intervals`, even seeds), and 4.5 times the first change is missing, 2.9 times by the other.
SPLIT_RINGS = SPLIT._replace(safety=5.0)


def estimated(field, solve):
    """Estimate of a field."""
    rule, shape = RULES[field.stats["rule"]], field.stats["voxels"]
    if field.scene.image is not None:
        times = shape[0] // field.scene.image.shape[0]

        def again(scene, parts):
            return solve(scene, voxels=[n * times * parts for n in scene.image.shape])

        split = SPLIT_RINGS if field.stats["scheme"] == "eyre-milton" else SPLIT
        return by_splitting(field, again, split._replace(most=split.most // times**3))
    if field.scene.resistances.any():
        rule = rule._replace(order=FILMS)

    def coarser(level):
        yield solve(field.scene, voxels=[max(1, round(n / rule.ratio**level)) for n in shape])

    half_diagonal = 0.5 * float(np.linalg.norm(np.array(field.scene.size) / shape))
    # A voxel that touches a small sphere, all of it, and what is left of the sphere itself.
    fine = Fine(unsure(field.scene, field.stats["rule"], shape), radius=2 * half_diagonal)
    found = by_refinement(field, coarser, rule, residual=field.stats["residual"], fine=fine)
    grids = [[max(1, round(n / rule.ratio**level)) for n in shape] for level in range(len(found.runs))]
    return _beside_edges(found, field, grids)


def _beside_edges(found: Estimate, field, grids) -> Estimate:
    """The same, at least as wide as edges within voxels of laminates ask for: coarser grids may miss as much by chance.

    Of 128, 91 and 64 voxels along a cell with a cube of .4 all miss about as much. Grids whose edges lie otherwise in
    voxels tell how much that is; those where they lie alike tell nothing, and it may be the most that was found.
    """
    if field.stats["rule"] != "laminate" or not (k := conductivity_of(field)) > 0:
        return found
    made = abs(k - float(field.scene.mean_conductivities[0]))
    share = field.fractions[1:] / max(float(field.fractions[1:].sum()), 1e-300)
    off = [float(share @ hidden(field.scene, grid)) * made for grid in grids]
    pairs = combinations(zip(found.runs, off, strict=True), 2)
    shown = max((abs(a - b) / max(abs(p - q), 1e-300) for (a, p), (b, q) in pairs), default=np.inf)
    half = min(HIDDEN, ALIKE * shown) * off[0]
    flux = max(found.flux, half / k * float(np.linalg.norm(field.mean_flux)))
    return found._replace(lower=max(min(found.lower, k - half), 0.0), upper=max(found.upper, k + half), flux=flux)


def extrapolated(field, solve):
    """What a field closes in on."""
    rule, shape = field.stats["rule"], field.stats["voxels"]
    if rule == "plain" or field.scene.resistances.any():
        raise NotImplementedError(
            "Field.extrapolated: errors of plain voxels, and of surfaces that resist, are chance from grid to grid; "
            "Field.error has an interval"
        )

    def larger(level):
        yield solve(field.scene, voxels=[max(1, round(n / LIMIT.ratio**level)) for n in shape])

    fine = Fine(unsure(field.scene, rule, shape))
    return by_extrapolation(field, larger, LIMIT, residual=field.stats["residual"], fine=fine)
