"""What a body's own symmetry saves: the planes that mirror it, its part between them, axes that conduct alike."""

from demheat.scene.symmetry.cut import Reduced, Unfolded, reduced, unfold
from demheat.scene.symmetry.maps import alike_axes, mirrors

__all__ = ["Reduced", "Unfolded", "alike_axes", "mirrors", "reduced", "unfold"]
