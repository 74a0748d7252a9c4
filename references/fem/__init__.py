"""Conduction by finite elements: linear or quadratic tetrahedra that conform to the scene's interfaces, or bricks.

The only home of scikit-fem. The mesh is gmsh's, the equations are assembled in blocks of elements (memory stays near
that of the matrix) and solved by conjugate gradients with a multigrid preconditioner.
"""

__all__ = ["evolve", "solve"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from references.fem.solver import solve

        return solve
    if name == "evolve":
        from references.fem.transient import evolve

        return evolve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
