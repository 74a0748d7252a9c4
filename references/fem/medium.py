"""What tensors, and temperatures, make of the conductivity of elements beside its mean: K = k S f(T).

k is a number for each element, S a tensor of its phase, the identity where it conducts alike all round, f the factor of
`demheat.scene.Dependence`.
"""

import numpy as np

from references.fem.elements import shapes
from references.fem.quadrature import rule

# Of the quadrature on straight elements, where conductivity times squares of slopes is integrated: linear in a linear
# temperature, and quadratic times squares of linear slopes in a quadratic one.
DEGREES = {4: 2, 10: 4}


class Medium:
    """Tensors and factors of the elements of a mesh."""

    def __init__(self, scene, mesh, temperature=None):
        self.mesh, self.temperature = mesh, temperature
        self.tensors = self.roots = self.factors = None
        if scene.anisotropic:
            mean = scene.mean_conductivities[:, None, None]
            self.tensors = np.where(mean > 0, scene.tensors / np.where(mean > 0, mean, 1.0), np.eye(3))
            self.roots = np.linalg.cholesky(self.tensors)
        if scene.varies and temperature is not None:
            self.factors = scene.dependences

    @property
    def straight(self):
        """Quadrature on straight elements, where the usual one does not do; else None."""
        return None if self.factors is None else rule(DEGREES[self.mesh.cells.shape[1]])

    def bent(self, ids, X, slopes):
        """Slopes of shape functions whose products are those of a stiffness, over its conductivity k."""
        if self.roots is not None:
            slopes = slopes @ self.roots[self.mesh.phase[ids], None]
        if self.factors is not None:
            values, _ = shapes(self.mesh.cells.shape[1], X)
            factor = self._factor(ids, self.temperature[self.mesh.cells[ids]] @ values.T)
            slopes = slopes * np.sqrt(factor)[..., None, None]
        return slopes

    def conducted(self, ids, temperature, gradient):
        """Gradients times S and f: minus the flux over the conductivity k."""
        if self.tensors is not None:
            gradient = np.einsum("bxy,b...y->b...x", self.tensors[self.mesh.phase[ids]], gradient)
        if self.factors is not None:
            gradient = self._factor(ids, temperature)[..., None] * gradient
        return gradient

    def _factor(self, ids, temperature):
        phase = self.mesh.phase[ids].reshape(-1, *[1] * (temperature.ndim - 1))
        return self.factors.factor(phase, temperature)
