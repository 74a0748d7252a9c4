"""Heat conduction in heterogeneous solids by the discrete element method, and what it is worth.

Importing this package loads NumPy only; the engine and its compiled kernels load with the first `solve` or
`evolve`.
"""

from demheat.field import Field, Samples
from demheat.laws import Calibrated, Laguerre, Platonic
from demheat.scene import Flux, Heating, Layer, Material, MovingCylinder, Scene, Sphere

__all__ = [
    "Calibrated",
    "Field",
    "Flux",
    "Heating",
    "Laguerre",
    "Layer",
    "Material",
    "MovingCylinder",
    "Platonic",
    "Samples",
    "Scene",
    "Sphere",
    "evolve",
    "solve",
]
__version__ = "0.1.0"


def __getattr__(name):
    if name in ("evolve", "solve"):
        from demheat import dem

        return getattr(dem, name)
    raise AttributeError(f"module 'demheat' has no attribute {name!r}")
