"""Conductivity that depends on temperature: equations at the last round's temperatures, until these meet their own.

Picard's iteration. Of a homogeneous body between two walls it takes off a part ln(k_max / k_min) / (2 pi) of the error
in each round.
"""

import numpy as np

from references.fem.multigrid import renewed, solve_free

# Rounds at most, and what each round's linear equations leave of the residual that it begins with.
ROUNDS, FURTHER = 60, 1e-2


def converged(solve, tolerance):
    """Repeat a solve at its own temperatures until these meet the equations that they make."""
    solved = solve(None, FURTHER)
    total = solved.stats["iterations"]
    for rounds in range(1, ROUNDS + 1):
        solved = solve(solved.temperature, tolerance)
        total += solved.stats["iterations"]
        stats = dict(solved.stats)
        # What pores are filled with has a residual of its own.
        left = stats.pop("before")
        if left <= tolerance:
            return solved._replace(stats=stats | {"iterations": total, "rounds": rounds})
    raise RuntimeError(
        f"finite elements: residual {left:.2e} > tolerance {tolerance:.2e} after {ROUNDS} rounds, "
        "each with conductivities at the last one's temperatures; must be a smaller change of conductivity, or larger"
    )


def improved(mesh, matrix, load, fixed, dof, tolerance, *, start, kept):
    """A solution improved, unless it meets the equations."""
    free = ~fixed & (matrix.diagonal() > 0)
    start = np.where(free, start, 0.0)
    left, root = load - matrix @ start, np.sqrt(matrix.diagonal()[free])
    size, whole = np.linalg.norm(left[free] / root), np.linalg.norm(load[free] / root)
    first = float(size / whole) if whole > 0 else 0.0
    stats = {"unknowns": int(free.sum()), "iterations": 0}
    if first > tolerance:
        aim = max(FURTHER, 0.5 * tolerance / first)
        change, found = solve_free(mesh, matrix, left, fixed, dof, min(aim, 0.5), kept=renewed(kept, matrix))
        start, stats = start + change, stats | {"iterations": found["iterations"]}
    return start, stats | {"residual": first, "before": first}
