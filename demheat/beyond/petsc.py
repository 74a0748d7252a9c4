"""PETSc's conjugate gradients and multigrid, as all who solve with them set them up."""

# PETSc's own algebraic multigrid, by smoothed aggregates; other thresholds and aggregates take as much memory.
DEFAULTS = {"pc_type": "gamg", "pc_gamg_type": "agg", "pc_gamg_agg_nsmooths": "1", "pc_gamg_threshold": "0.01"}
PREFIX = "demheat_"


def solver_of(matrix, options: str, petsc, comm):
    """What solves with a matrix of all ranks, by the norm of the residual itself."""
    know(options, petsc)
    solver = conjugate_gradients(matrix, petsc, comm)
    solver.setUp()
    return solver


def know(options: str, petsc) -> None:
    """Tell PETSc its options, those of `DEFAULTS` where no others are given, for what has the prefix `PREFIX`."""
    known = petsc.Options()
    for name, value in DEFAULTS.items():
        known[PREFIX + name] = value
    words = options.split()
    known.insertString(" ".join("-" + PREFIX + word[1:] if _is_name(word) else word for word in words))


def conjugate_gradients(matrix, petsc, comm):
    """Conjugate gradients with the options that PETSc knows, not set up yet."""
    solver = petsc.KSP().create(comm)
    solver.setOptionsPrefix(PREFIX)
    solver.setType("cg")
    solver.setNormType(petsc.KSP.NormType.UNPRECONDITIONED)
    solver.setOperators(matrix)
    solver.setFromOptions()
    return solver


def _is_name(word):
    return word[0] == "-" and word[1:2].isalpha()
