"""What scenes and laws can be solved by parts of a body."""

from __future__ import annotations

from demheat.conduction.steady import check_solver
from demheat.dem.options import Particles
from demheat.laws import Laguerre
from demheat.scene import Scene, check_scene


def check(scene: Scene, law: Laguerre, wanted: Particles, tolerance: float, *, knows: str) -> None:
    """Raise unless a scene can be solved slab by slab."""
    check_scene(scene)
    check_solver("auto", tolerance)
    if not isinstance(law, Laguerre):
        raise ValueError(f"law = {law!r}: must be a Laguerre, whose cells can be made by slabs")
    scene.require(knows, steady=True, domain="box", pores=False, takes=("resistance", "exchange"))
    if scene.radiates:
        raise NotImplementedError(f"walls that radiate: {knows}")
    law.check(scene)
    wanted.check(scene, law)
