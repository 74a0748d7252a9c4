"""What an integrator's step takes and gives."""

from typing import NamedTuple

import numpy as np


class Step(NamedTuple):
    """One step of an integrator.

    Attributes
    ----------
    x : (N,) float array, K
        At the new time, held nodes included.
    inflow : (8,) float array, J
        Heat that came in meanwhile by side, sources last, with the integrator's own weights.
    error : (N,) float array, K, or None
        Estimate of the error of this step, if asked for.
    stages, iterations : int
        Evaluations of the rate, and iterations of the linear solver.
    memory : object
        What the next step may use, if this one is accepted.
    residual : float, K
        Bound on the error that the linear solver left, from its recomputed residual.
    """

    x: np.ndarray
    inflow: np.ndarray
    error: np.ndarray | None
    stages: int
    iterations: int = 0
    memory: object = None
    residual: float = 0.0
