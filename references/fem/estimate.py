"""How far a finite element solution is off, by coarser meshes of the same scene."""

from demheat.error import Refinement, by_refinement

# Meshes follow features: all their edges are made so many times longer, not the largest alone.
RATIO = 1.4
# Of quadratic elements on curved surfaces, the same on straight ones, linear ones and bricks.
RULES = {
    "curved": Refinement(RATIO, 2, 2.0, 2.0, 2.0, 1.2, coats=1.0),
    "straight": Refinement(RATIO, 2, 2.0, 2.5, 2.0, 1.2),
    "linear": Refinement(RATIO, 2, 2.0, 4.5, 2.0, 2.0),
}


def estimated(field, coarser, kind, *, steps=0.0):
    """Estimate of a field."""
    left = {"residual": field.stats["residual"], "steps": steps}
    return by_refinement(field, lambda level: coarser(RATIO**level), RULES[kind], how="coarser meshes", **left)
