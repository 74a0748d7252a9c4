"""What an integrator's step takes and gives."""

from typing import NamedTuple

import numpy as np


class Step(NamedTuple):
    """One step of an integrator."""

    x: np.ndarray  # (N,) float array, K: At the new time, held nodes included
    # (8,) float array, J: Heat that came in meanwhile by side, sources last, with the integrator's own weights
    inflow: np.ndarray
    error: np.ndarray | None  # (N,) float array, K, or None: Estimate of the error of this step, if asked for
    # stages, iterations: Evaluations of the rate, and iterations of the linear solver
    stages: int
    iterations: int = 0
    memory: object = None  # What the next step may use, if this one is accepted
    residual: float = 0.0  # K: Bound on the error that the linear solver left, from its recomputed residual
