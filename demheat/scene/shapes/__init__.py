"""Shapes of inclusions, one per file: `Sphere`, `Layer`, and `Shape`, which says what the next one must supply."""

from demheat.scene.shapes.base import Shape
from demheat.scene.shapes.layer import Layer
from demheat.scene.shapes.sphere import Sphere

__all__ = ["Layer", "Shape", "Sphere"]
