"""Two values between which a conductivity certainly lies, or a tensor of them; of meshes and of voxels alike."""

import math
from dataclasses import dataclass, field

import numpy as np

from demheat.scene import Layer, Scene, Sphere, check_scene
from demheat.scene.inputs import finite

# More than rounding makes of sums over millions of elements: bounds of exact solutions, as of laminates, need it.
ROUNDING = 1e-11


@dataclass(frozen=True)
class Bracket:
    """Bounds of a conductivity."""

    # lower, upper: W/(m K): The scene's conductivity along its load lies between them
    lower: float
    upper: float
    # `size` (m), `elements`, `temperatures` and `fluxes`, each with `unknowns`, `iterations` and `residual`;
    # `unbalanced`, how much of the lower bound was given up for the residual; `cpu_s` of mesh, lower and upper
    stats: dict = field(repr=False, default_factory=dict)

    @property
    def width(self) -> float:
        """Upper over lower bound, less 1; 0 where both are 0."""
        if self.lower > 0:
            return self.upper / self.lower - 1
        return 0.0 if self.upper == 0 else math.inf


@dataclass(frozen=True)
class Tensor:
    """Bounds of a conductivity tensor."""

    # least, greatest: (3, 3) float array, W/(m K): Symmetric. Along any direction g the conductivity lies between g .
    # least g and g . greatest g
    least: np.ndarray
    greatest: np.ndarray
    stats: dict = field(repr=False, default_factory=dict)  # `size` (m) and `elements`

    @property
    def middle(self) -> np.ndarray:
        """Halfway between both, (3, 3) float array, W/(m K)."""
        return (self.least + self.greatest) / 2

    @property
    def radius(self) -> np.ndarray:
        """What each entry may be off from the middle, (3, 3) float array, W/(m K).

        Where E and D/2 - E and D/2 + E are the true tensor less the middle, and non-negative, |E_ij| is at most half
        the root of D_ii D_jj.
        """
        apart = np.diagonal(self.greatest - self.least)
        return np.sqrt(np.outer(apart, apart)) / 2

    @property
    def lower(self) -> np.ndarray:
        """Lower bound of each entry, (3, 3) float array, W/(m K)."""
        return self.middle - self.radius

    @property
    def upper(self) -> np.ndarray:
        """Upper bound of each entry, (3, 3) float array, W/(m K)."""
        return self.middle + self.radius


def check(scene: Scene, tolerance: float, *, takes: tuple[str, ...] = ()) -> None:
    """Refuse what has no bounds here; raises what `solve` does."""
    check_scene(scene)
    finite("tolerance", tolerance, "a number between 0 and 1", lambda v: 0 < v < 1)
    text = "bounds are known on spheres and layers in a box"
    scene.require(text, steady=True, domain="box", shapes=(Sphere, Layer), takes=takes)
