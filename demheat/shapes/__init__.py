"""Shapes of inclusions, one per file: `Sphere`, `Layer`, and `Shape`, which says what the next one must supply."""

from demheat.shapes.base import Shape
from demheat.shapes.layer import Layer
from demheat.shapes.sphere import Sphere

__all__ = ["Layer", "Shape", "Sphere"]
