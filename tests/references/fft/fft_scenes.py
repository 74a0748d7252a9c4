"""Scenes for the solvers on voxels, and random values for their transforms."""

import numpy as np

from demheat.scene import Material, Scene, Sphere
from references.fft.transforms import fourier

SCHEMES = ("cg", "eyre-milton")
RULES = [("cg", "plain"), ("cg", "laminate"), ("cg", "links"), ("eyre-milton", "plain"), ("eyre-milton", "laminate")]
# Radius a third of the edge, k / k_m of the simple cubic array, from Rayleigh's multipole method (all digits right).
EXACT = {0.01: 0.786847280, 0.1: 0.812845293, 10.0: 1.395734838, 100.0: 1.533386809, 1e6: 1.552615028}


def sphere_cell(contrast, *, axis=0, center=(0.5, 0.5, 0.5), walls=False, matrix=1.0, size=1.0):
    load = {"walls": {"xyz"[axis] + "-": 20.0, "xyz"[axis] + "+": 30.0}} if walls else {"gradient": np.eye(3)[axis]}
    sphere = Sphere([size * c for c in center], size / 3, Material(matrix * contrast))
    return Scene((size,) * 3, Material(matrix), [sphere], **load)


def dispersion(gradient=None, walls=None):
    """A shell with a core, a poor and a good sphere, two of them across faces; no symmetry at all."""
    good, poor = Material(8.0), Material(0.3)
    spheres = [
        Sphere((0.31, 0.42, 0.55), 0.26, good),
        Sphere((0.33, 0.40, 0.52), 0.15, poor),
        Sphere((0.80, 0.95, 0.12), 0.18, poor),
        Sphere((0.77, 0.61, 0.70), 0.17, good),
    ]
    return Scene((1.0, 1.2, 0.9), Material(1.0), spheres, gradient=gradient, walls=walls)


def filled(shape, dtype=np.float64, threads=2):
    """A Fourier transform of two components, and the random values that it holds."""
    transform = fourier(2, shape, dtype, threads)
    values = np.random.default_rng(0).random((2, *shape)).astype(dtype)
    transform.real[..., : shape[2]] = values
    return transform, values
