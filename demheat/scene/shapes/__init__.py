"""Shapes of inclusions, one per file, and `Shape`, which says what the next one must supply."""

from demheat.scene.shapes.base import Shape as Shape
from demheat.scene.shapes.box import Box
from demheat.scene.shapes.cylinder import Cylinder
from demheat.scene.shapes.ellipsoid import Ellipsoid
from demheat.scene.shapes.half_space import HalfSpace
from demheat.scene.shapes.layer import Layer
from demheat.scene.shapes.level_set import LevelSet
from demheat.scene.shapes.sphere import Sphere
from demheat.scene.shapes.surface_mesh import SurfaceMesh
from demheat.scene.shapes.torus import Torus
from demheat.scene.shapes.union import Union

# In the order in which messages name them; all packages above show them, and files know those that say how.
__all__ = ["Sphere", "Layer", "Cylinder", "Ellipsoid", "Box", "HalfSpace", "Union", "LevelSet", "Torus", "SurfaceMesh"]
