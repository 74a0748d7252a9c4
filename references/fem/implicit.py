"""Solve (M / tau + K) x = b again and again, for steps that stay or change: what is set up is used while it serves."""

import math

import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import splu

from references.fem.multigrid import conjugate_gradients, multigrid

# Unknowns up to which factors precondition instead of multigrid: they cost less than the set-up of the latter.
DIRECT = 2500
# A preconditioner made for one tau serves up to this times longer or shorter ones: a few iterations more.
SERVES = 1.6
# Rounding of the sum of one row, relative to its diagonal times the temperatures.
ROUNDING = 1e-14


class Shifted:
    """The matrix M / tau + K at the free nodes."""

    def __init__(self, mass, stiffness, quadratic, tolerance, inverse=None):
        self.inverse, self.plain = inverse, stiffness
        self.mass, self.stiffness, self.quadratic, self.tolerance = mass, stiffness, quadratic, tolerance
        self.tau = self.made_for = None
        self.iterations, self.residual, self.setups = 0, 0.0, 0

    def stiffen(self, more):
        """Add a matrix to the stiffness as it was made, in place of one that was added before."""
        self.stiffness, self.tau = (self.plain + more).tocsr(), None

    def solve(self, tau, load, *, scale=None, level=None, tolerance=None):
        """Solution for one load."""
        if not len(load):
            return np.zeros(0)
        self._set(tau)
        wanted, b = tolerance or self.tolerance, load / self.root
        size = np.linalg.norm(b)
        if size == 0:
            return np.zeros(len(load))
        usual = 0.0 if scale is None else np.linalg.norm(scale / self.root)
        least = 0.0 if level is None else ROUNDING * np.linalg.norm(self.root * level) / wanted
        part = size / max(size, usual, least)
        x, iterations, residual = conjugate_gradients(self.A, b, self.precondition, wanted / part)
        self._record(iterations, residual * part, wanted, f"tau = {tau:.3g} s")
        if tolerance is None:
            self.residual = max(self.residual, float(residual * part))
        return x / self.root

    def rates(self, load):
        """Solution of M x = load, whose matrix needs no preconditioner but its diagonal, (n,) float array, K/s."""
        if not load.any():
            return np.zeros(len(load))
        root = np.sqrt(self.mass.diagonal())
        scale = diags(1 / root)
        A = (scale @ self.mass @ scale).tocsr()
        x, iterations, residual = conjugate_gradients(A, load / root, lambda r: r, self.tolerance)
        self._record(iterations, residual, self.tolerance, "the mass matrix")
        return x / root

    def _record(self, iterations, residual, wanted, what):
        if not residual <= wanted:
            raise RuntimeError(
                f"finite elements: residual {residual:.2e} > tolerance {wanted:.2e} after {iterations} iterations on "
                f"{self.mass.shape[0]} unknowns, {what}"
            )
        self.iterations += iterations

    def _set(self, tau):
        if tau == self.tau:
            return
        A = (self.mass * (1 / tau) + self.stiffness).tocsr()
        self.tau, self.root = tau, np.sqrt(A.diagonal())
        scale = diags(1 / self.root)
        self.A = (scale @ A @ scale).tocsr()
        if self.inverse is not None:
            self.precondition = lambda r: self.root * self.inverse(tau, self.root * r)
        elif self.made_for is None or abs(math.log(tau / self.made_for)) > math.log(SERVES):
            self.made_for, self.setups = tau, self.setups + 1
            if len(self.root) <= DIRECT:
                options = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
                self.precondition = splu(self.A.tocsc(), **options).solve
            else:
                self.precondition = multigrid(self.A, self.root, self.quadratic)
