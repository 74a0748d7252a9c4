"""A scene with its axes in another order: a turn by right angles, or a mirror."""

from collections.abc import Sequence
from dataclasses import replace

from demheat.scene.scene import Scene


def turned(scene: Scene, order: Sequence[int]) -> Scene:
    """The same box of materials and its load with axes order[0], order[1], order[2] as axes 0, 1, 2."""
    if tuple(order) == (0, 1, 2):
        return scene

    def along(vector):
        return tuple(vector[axis] for axis in order)

    shapes = [replace(s.turned(order), material=s.material.turned(order)) for s in scene.inclusions]
    place = {axis: new for new, axis in enumerate(order)}
    walls = scene.walls and {"xyz"[place["xyz".index(name[0])]] + name[1]: v for name, v in scene.walls.items()}
    gradient = scene.gradient and along(scene.gradient)
    body = {
        "matrix": scene.matrix.turned(order),
        "inclusions": shapes,
        "image": scene.image and scene.image.turned(order),
    }
    return replace(scene, size=along(scene.size), walls=walls, gradient=gradient, **body)
