"""Heat conduction in heterogeneous solids by the discrete element method, and what it is worth.

Importing this package loads NumPy only; the engine and its compiled kernels load with the first `solve` or
`evolve`.
"""

import warnings

from demheat import terminal  # noqa: F401 - first, so that a command is interrupted without a traceback from here on
from demheat.deadline import budget
from demheat.field import Field, Samples
from demheat.laws import Calibrated, Laguerre, Platonic
from demheat.progress import on_progress
from demheat.scene import (
    Box,
    Convection,
    Cylinder,
    Dependence,
    Ellipsoid,
    Flux,
    HalfSpace,
    Image,
    Layer,
    LevelSet,
    Material,
    MovingCylinder,
    Radiation,
    Scene,
    Sphere,
    UniformSource,
    Union,
    orthotropic,
)

__all__ = [
    "Box",
    "Calibrated",
    "Convection",
    "Cylinder",
    "Dependence",
    "Ellipsoid",
    "Field",
    "Flux",
    "HalfSpace",
    "Image",
    "Laguerre",
    "Layer",
    "LevelSet",
    "Material",
    "MovingCylinder",
    "Platonic",
    "Radiation",
    "Samples",
    "Scene",
    "Sphere",
    "UniformSource",
    "Union",
    "budget",
    "effective",
    "evolve",
    "on_progress",
    "orthotropic",
    "recommend",
    "solve",
    "sweep",
]
__version__ = "0.2.0"
RENAMED = {"Heating": "UniformSource"}


def __getattr__(name):
    if name in ("evolve", "solve"):
        from demheat import dem

        return getattr(dem, name)
    if name in ("effective", "recommend"):
        from demheat import cheapest

        return getattr(cheapest, name)
    if name == "sweep":
        from demheat.sweeps import sweep

        return sweep
    if name in RENAMED:
        warnings.warn(f"demheat.{name} is now demheat.{RENAMED[name]}", DeprecationWarning, stacklevel=2)
        return globals()[RENAMED[name]]
    raise AttributeError(f"module 'demheat' has no attribute {name!r}")
