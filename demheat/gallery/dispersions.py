"""Dispersions: spheres placed at random, one by one or by collisions."""

import math
from collections.abc import Sequence

import numpy as np

from demheat.addition import MOST_FILLED, add_spheres
from demheat.gallery.cells import AXIS, EDGE, TEMPERATURES, cube, loaded
from demheat.powers import power
from demheat.runtime.limits import check_memory
from demheat.scene import Material, Scene, Sphere
from demheat.scene.inputs import finite, flag, whole

# Least bytes that a sphere takes, here and in a scene.
BYTES = 500
# Silica spheres in epoxy, Haddad et al. 2021, section 4.3.
EPOXY, SILICA = Material(conductivity=0.195), Material(conductivity=1.5)


def random_dispersion(
    count: int | None = None,
    *,
    fraction: float | None = None,
    diameter: float = 1 / 6,
    gap: float = 0.05,
    seed: int = 0,
    edge: float = EDGE,
    matrix: Material = EPOXY,
    inclusion: Material = SILICA,
    periodic: bool = True,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
    """Equal spheres dropped one by one at random, refused where they come too close (random sequential addition).

    By default silica in epoxy with six diameters to the edge, as in Haddad et al. 2021, section 4.3. Between walls all
    spheres lie inside the box; a periodic cell lets them cross its faces.

    Parameters
    ----------
    count : int, optional
        Number of spheres; by default that of the fraction, rounded.
    fraction : float, optional
        Volume fraction, 0.2 if neither is given. With both, the diameter follows.
    diameter : float
        In units of the edge.
    gap : float
        Least distance between two surfaces, and between a surface and a wall, in diameters.
    seed : int
        Of NumPy's default generator; the same seed gives the same spheres, on any x86-64 processor.
    edge : float, m
    matrix, inclusion : Material
    periodic, axis, temperatures
        As those of `loaded`, but a periodic cell by default.

    Raises
    ------
    ValueError
        If the spheres, with half the gap around each, fill more than 0.35 of the box, or an argument is out of range.
    RuntimeError
        If 200 000 trials in a row found no room.
    """
    size = cube(edge, {"matrix": matrix, "inclusion": inclusion})
    count, diameter = _dispersion(count, fraction, diameter)
    finite("gap", gap, "a finite number >= 0, in diameters", lambda v: v >= 0)
    whole("seed", seed, "an integer >= 0", lambda v: v >= 0)
    filled = count * math.pi / 6 * (diameter * (1 + gap)) ** 3
    if filled > MOST_FILLED:
        raise ValueError(
            f"count = {count}, diameter = {diameter:.4g}, gap = {gap}: spheres and gaps fill {filled:.3f} of the box; "
            f"adding one by one reaches at most {MOST_FILLED}"
        )
    flag("periodic", periodic)
    margin = 0.0 if periodic else diameter * (0.5 + gap)
    if 2 * margin >= 1:
        raise ValueError(f"diameter = {diameter!r}: spheres and gaps must fit between the walls")
    wide, rng = np.full(count, diameter * (1 + gap) / 2), np.random.default_rng(seed)
    centers = add_spheres(wide, np.ones(3), rng, periodic=periodic, margin=margin, reuse=True)
    spheres = [Sphere(center, diameter * edge / 2, inclusion) for center in centers * edge]
    return Scene(size, matrix, spheres, **loaded(size, periodic, axis, temperatures))


def dispersion(
    count: int = 50,
    *,
    fraction: float = 0.3,
    ratio: float = 1.0,
    gap: float = 0.02,
    seed: int = 0,
    edge: float = EDGE,
    matrix: Material = EPOXY,
    inclusion: Material = SILICA,
    periodic: bool = True,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
    """Many spheres at random, equal or not, in equilibrium; denser than one after the other reaches.

    Placed by collisions (`demheat.packing.dispersion`), in some 4 CPU-seconds for each thousand, and kept on disk.

    Parameters
    ----------
    count : int
        Number of spheres, 2 to 100 000.
    fraction : float
        Volume fraction, with the gaps at most 0.63.
    ratio : float
        Largest radius over the smallest, at most 100; radii are spread evenly in their logarithm.
    gap : float
        Least distance between two surfaces, and between a surface and a wall, in diameters of the sphere of mean
        volume.
    seed : int
        As that of `random_dispersion`, with the same C library: collisions grow its last bits.
    edge : float, m
    matrix, inclusion : Material
        By default silica in epoxy, contrast 7.692.
    periodic, axis, temperatures
        As those of `loaded`, but a periodic cell by default.

    Raises
    ------
    ValueError
        If an argument is out of range, or the spheres with their gaps are too many or too large for the box.
    """
    from demheat.packing.dispersion import dispersion as placed

    whole("count", count, "an integer >= 2", lambda v: v >= 2)
    check_memory("count", count, BYTES * int(count))
    finite("ratio", ratio, "a number between 1 and 100", lambda v: 1 <= v <= 100)
    size = cube(edge, {"matrix": matrix, "inclusion": inclusion})
    flag("periodic", periodic)
    radii = power(float(ratio), np.linspace(0.0, 1.0, count))
    how = {"fraction": fraction, "gap": gap, "seed": seed, "periodic": periodic}
    centers, radii = placed(int(count), size=size, radii=radii, **how)
    spheres = [Sphere(center, radius, inclusion) for center, radius in zip(centers, radii, strict=True)]
    return Scene(size, matrix, spheres, **loaded(size, periodic, axis, temperatures))


def _dispersion(count, fraction, diameter):
    """Number of spheres and their diameter in edges."""
    if fraction is not None:
        finite("fraction", fraction, "a number between 0 and 1", lambda v: 0 < v < 1)
    if count is not None:
        whole("count", count, "an integer >= 1", lambda v: v >= 1)
        check_memory("count", count, BYTES * int(count))
    finite("diameter", diameter, "a number between 0 and 1, in edges of the box", lambda v: 0 < v < 1)
    if count is None:
        return max(1, round((0.2 if fraction is None else fraction) * 6 / (math.pi * diameter**3))), diameter
    return count, diameter if fraction is None else (6 * fraction / (math.pi * count)) ** (1 / 3)
