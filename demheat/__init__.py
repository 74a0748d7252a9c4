"""Heat conduction in heterogeneous solids by the discrete element method, and what it is worth.

Importing this package loads NumPy only; the engine and its compiled kernels load with the first `solve` or
`evolve`.
"""

from typing import TYPE_CHECKING

import demheat.renamed as _renamed  # noqa: F401 - and then old names
import demheat.terminal.ends as _ends  # noqa: F401 - first: from here on a command is interrupted without a traceback
from demheat.field import Field, Samples
from demheat.io.fields import write as _write
from demheat.io.libraries import to_dataframe as _to_dataframe
from demheat.io.libraries import to_pyvista as _to_pyvista
from demheat.io.libraries import to_xarray as _to_xarray
from demheat.laws import Calibrated, Laguerre, Platonic
from demheat.runtime.deadline import budget
from demheat.runtime.lazy import lazy_names
from demheat.runtime.progress import on_progress
from demheat.scene import (
    Convection,
    Dependence,
    Flux,
    Image,
    Material,
    MovingCylinder,
    Radiation,
    Scene,
    UniformSource,
    orthotropic,
)
from demheat.scene import shapes as _shapes
from demheat.scene.shapes import *  # noqa: F403 - a new shape is named there and nowhere else
from demheat.terminal.pictures import plot_field as _plot_field
from demheat.terminal.pictures import plot_scene as _plot_scene
from demheat.version import __version__ as __version__

if TYPE_CHECKING:
    from demheat.cheapest.effective import effective, recommend
    from demheat.dem import evolve, solve
    from demheat.sweeps import sweep

__all__ = [
    "Calibrated",
    "Convection",
    "Dependence",
    "Field",
    "Flux",
    "Image",
    "Laguerre",
    "Material",
    "MovingCylinder",
    "Platonic",
    "Radiation",
    "Samples",
    "Scene",
    "UniformSource",
    "budget",
    "effective",
    "evolve",
    "on_progress",
    "orthotropic",
    "recommend",
    "solve",
    "sweep",
]
__all__ += _shapes.__all__
HOMES = {
    "demheat.cheapest": ("effective", "recommend"),
    "demheat.dem": ("evolve", "solve"),
    "demheat.sweeps": ("sweep",),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)

# What is solved knows nothing of those who store and draw it: it is given them here.
Field.plot, Field.write, Scene.plot = _plot_field, _write, _plot_scene
Field.to_dataframe, Field.to_xarray, Field.to_pyvista = _to_dataframe, _to_xarray, _to_pyvista
