"""What is computed: a scene, its shapes and materials, its loads and sources; NumPy is all that it needs."""

from demheat.scene import shapes
from demheat.scene.bodies import ROUND_AXES, WALLS, domain_volume, wall_names
from demheat.scene.dependence import Dependence
from demheat.scene.image import Image
from demheat.scene.material import Material
from demheat.scene.parts import STEFAN_BOLTZMANN, Convection, Flux, MovingCylinder, Radiation, UniformSource
from demheat.scene.scene import Scene, check_scene
from demheat.scene.shapes import *  # noqa: F403 - a new shape is named there and nowhere else
from demheat.scene.shapes import Shape
from demheat.scene.tensors import orthotropic

__all__ = [
    "ROUND_AXES",
    "STEFAN_BOLTZMANN",
    "WALLS",
    "Convection",
    "Dependence",
    "Flux",
    "Image",
    "Material",
    "MovingCylinder",
    "Radiation",
    "Scene",
    "Shape",
    "UniformSource",
    "check_scene",
    "domain_volume",
    "orthotropic",
    "wall_names",
    *shapes.__all__,
]
