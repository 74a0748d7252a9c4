"""Named scenes. Every function gives a good default and takes the same load knobs.

`periodic=True` makes a periodic cell, else two opposite walls are held at a temperature and the other four faces are
insulated. `axis` is the axis of the load; `temperatures` are those of its low and its high wall; in a periodic cell
their difference over the length of the box is the mean gradient, so both loads drive the same mean flux.
"""

from __future__ import annotations

import math

import numpy as np

from demheat.addition import MOST_FILLED, add_spheres
from demheat.scene import Layer, Material, Scene, Sphere

# The cube of Haddad et al. 2021, section 4: a steel-like matrix, 0.1 m, 25 and 35 degrees C. (Their Table 1 prints a
# specific heat of 0.9 J/(kg K), a thousand times too small for a metal; it is kept so that their figures come out.)
HADDAD = Material(conductivity=33.0, density=7800.0, heat_capacity=0.9)
EDGE = 0.1
TEMPERATURES = (25.0, 35.0)
# Silica spheres in epoxy, Haddad et al. 2021, section 4.3.
EPOXY, SILICA = Material(conductivity=0.195), Material(conductivity=1.5)


def slab(*, size=(EDGE, EDGE, EDGE), material=HADDAD, periodic=False, axis=1, temperatures=TEMPERATURES):
    """Homogeneous box."""
    return Scene(size, material, **_load(size, periodic, axis, temperatures))


def laminate(
    *,
    direction="across",
    contrast=5.0,
    layers=2,
    edge=EDGE,
    matrix=HADDAD,
    periodic=False,
    axis=1,
    temperatures=TEMPERATURES,
):
    """Cube of equally thick layers of matrix and of a second material in turn.

    Parameters
    ----------
    direction : {"across", "along"}
        Heat flows across the layers (harmonic mean) or along them (arithmetic mean).
    contrast : float
        Conductivity of the second material over that of the matrix.
    layers : int
        Number of layers of the second material.
    edge : float, m
    matrix : Material
    """
    if direction not in ("across", "along"):
        raise ValueError(f"direction = {direction!r}: must be 'across' or 'along'")
    if not isinstance(layers, int) or layers < 1:
        raise ValueError(f"layers = {layers!r}: must be an integer >= 1")
    normal = axis if direction == "across" else (axis + 1) % 3
    second, pitch = scaled(matrix, contrast), edge / layers
    # Centred in its period, so that no interface lies on a wall.
    painted = [Layer(normal, (i + 0.25) * pitch, (i + 0.75) * pitch, second) for i in range(layers)]
    size = (edge,) * 3
    return Scene(size, matrix, painted, **_load(size, periodic, axis, temperatures))


def sphere_in_cube(
    contrast=5.0,
    *,
    radius=None,
    fraction=None,
    edge=EDGE,
    matrix=HADDAD,
    periodic=False,
    axis=1,
    temperatures=TEMPERATURES,
):
    """Sphere at the centre of a cube, the single inclusion of Haddad et al. 2021, section 4.1.

    Parameters
    ----------
    contrast : float
        Conductivity of the sphere over that of the matrix.
    radius : float, m, optional
        A third of the edge by default (volume fraction 4 pi/81 = 0.155).
    fraction : float, optional
        Volume fraction, instead of the radius.
    edge : float, m
    matrix : Material
    """
    if radius is not None and fraction is not None:
        raise ValueError(f"radius = {radius!r}, fraction = {fraction!r}: give one of them, not both")
    if fraction is not None:
        radius = _radius(fraction, 1, edge)
    size = (edge,) * 3
    sphere = Sphere((edge / 2,) * 3, edge / 3 if radius is None else radius, scaled(matrix, contrast))
    return Scene(size, matrix, [sphere], **_load(size, periodic, axis, temperatures))


def simple_cubic(contrast=10.0, *, fraction=0.3, edge=EDGE, matrix=HADDAD, axis=1, temperatures=TEMPERATURES):
    """Periodic cell of the simple cubic array, its sphere at the centre.

    Parameters
    ----------
    contrast : float
        Conductivity of the spheres over that of the matrix.
    fraction : float
        Volume fraction; spheres touch at pi/6 = 0.5236.
    edge : float, m
    matrix : Material
    """
    sites = [(0.5, 0.5, 0.5)]
    return _array(sites, contrast, fraction, edge, matrix, axis, temperatures)


def body_centred(contrast=10.0, *, fraction=0.3, edge=EDGE, matrix=HADDAD, axis=1, temperatures=TEMPERATURES):
    """Periodic cell of the body-centred cubic array, two spheres; they touch at 0.6802. Arguments: `simple_cubic`."""
    sites = [(0.25, 0.25, 0.25), (0.75, 0.75, 0.75)]
    return _array(sites, contrast, fraction, edge, matrix, axis, temperatures)


def face_centred(contrast=10.0, *, fraction=0.3, edge=EDGE, matrix=HADDAD, axis=1, temperatures=TEMPERATURES):
    """Periodic cell of the face-centred cubic array, four spheres; they touch at 0.7405. Arguments: `simple_cubic`."""
    sites = [(0.25, 0.25, 0.25), (0.25, 0.75, 0.75), (0.75, 0.25, 0.75), (0.75, 0.75, 0.25)]
    return _array(sites, contrast, fraction, edge, matrix, axis, temperatures)


def coated_sphere(
    core=165.0,
    shell=16.5,
    *,
    radius=0.3,
    core_fraction=0.4,
    center=(0.5, 0.5, 0.5),
    edge=EDGE,
    periodic=False,
    axis=1,
    temperatures=TEMPERATURES,
):
    """Hashin's coated sphere in the matrix that does not notice it: outside, the temperature is exactly linear.

    The matrix has k* = k1 (1 + 2 beta f)/(1 - beta f), beta = (k2 - k1)/(k2 + 2 k1) (Hashin, J. Appl. Mech. 29 (1962)
    143), with k1 of the shell, k2 of the core and f the core's share of the coated sphere.

    Parameters
    ----------
    core, shell : float, W/(m K)
    radius : float
        Outer radius, in units of the edge.
    core_fraction : float
        f, volume of the core over that of the coated sphere.
    center : (3,) sequence of float
        In units of the edge.
    edge : float, m
    """
    if not 0 < core_fraction < 1:
        raise ValueError(f"core_fraction = {core_fraction!r}: must lie between 0 and 1")
    k1, k2 = Material(shell).conductivity, Material(core).conductivity
    # The quotient above times (k2 + 2 k1), so that nothing divides by zero as long as one conductivity is not.
    weight = k2 + 2 * k1 - (k2 - k1) * core_fraction
    neutral = k1 * (k2 + 2 * k1 + 2 * (k2 - k1) * core_fraction) / weight if weight else 0.0
    middle, size = tuple(c * edge for c in center), (edge,) * 3
    spheres = [
        Sphere(middle, radius * edge, Material(k1)),
        Sphere(middle, radius * edge * core_fraction ** (1 / 3), Material(k2)),
    ]
    return Scene(size, Material(neutral), spheres, **_load(size, periodic, axis, temperatures))


def random_dispersion(
    count=None,
    *,
    fraction=None,
    diameter=1 / 6,
    gap=0.05,
    seed=0,
    edge=EDGE,
    matrix=EPOXY,
    inclusion=SILICA,
    periodic=True,
    axis=1,
    temperatures=TEMPERATURES,
):
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
        Of NumPy's default generator; the same seed gives the same spheres.
    edge : float, m
    matrix, inclusion : Material

    Raises
    ------
    ValueError
        If the spheres, with half the gap around each, fill more than 0.35 of the box, or an argument is out of range.
    RuntimeError
        If 200 000 trials in a row found no room.
    """
    count, diameter = _dispersion(count, fraction, diameter)
    if not (math.isfinite(gap) and gap >= 0):
        raise ValueError(f"gap = {gap!r}: must be a finite number >= 0, in diameters")
    filled = count * math.pi / 6 * (diameter * (1 + gap)) ** 3
    if filled > MOST_FILLED:
        raise ValueError(
            f"count = {count}, diameter = {diameter:.4g}, gap = {gap}: spheres and gaps fill {filled:.3f} of the box; "
            f"adding one by one reaches at most {MOST_FILLED}"
        )
    margin = 0.0 if periodic else diameter * (0.5 + gap)
    if 2 * margin >= 1:
        raise ValueError(f"diameter = {diameter!r}: spheres and gaps must fit between the walls")
    wide, rng = np.full(count, diameter * (1 + gap) / 2), np.random.default_rng(seed)
    centers = add_spheres(wide, np.ones(3), rng, periodic=periodic, margin=margin, reuse=True)
    size = (edge,) * 3
    spheres = [Sphere(center, diameter * edge / 2, inclusion) for center in centers * edge]
    return Scene(size, matrix, spheres, **_load(size, periodic, axis, temperatures))


def scaled(material, contrast):
    """The material with its conductivity multiplied by `contrast`, all else kept."""
    return Material(material.conductivity * contrast, material.density, material.heat_capacity)


def _load(size, periodic, axis, temperatures):
    if axis not in (0, 1, 2):
        raise ValueError(f"axis = {axis!r}: must be 0, 1 or 2")
    low, high = temperatures
    if periodic:
        gradient = [0.0, 0.0, 0.0]
        gradient[axis] = (high - low) / size[axis]
        return {"gradient": gradient}
    return {"walls": {"xyz"[axis] + "-": low, "xyz"[axis] + "+": high}}


def _radius(fraction, spheres, edge):
    if not (math.isfinite(fraction) and fraction > 0):
        raise ValueError(f"fraction = {fraction!r}: must be a finite number > 0")
    return edge * (3 * fraction / (4 * math.pi * spheres)) ** (1 / 3)


def _array(sites, contrast, fraction, edge, matrix, axis, temperatures):
    radius, material = _radius(fraction, len(sites), edge), scaled(matrix, contrast)
    spheres = [Sphere(tuple(c * edge for c in site), radius, material) for site in sites]
    size = (edge,) * 3
    return Scene(size, matrix, spheres, **_load(size, True, axis, temperatures))


def _dispersion(count, fraction, diameter):
    """Number of spheres and their diameter in edges."""
    if fraction is not None and not 0 < fraction < 1:
        raise ValueError(f"fraction = {fraction!r}: must lie between 0 and 1")
    if count is not None and (not isinstance(count, int | np.integer) or count < 1):
        raise ValueError(f"count = {count!r}: must be an integer >= 1")
    if not 0 < diameter < 1:
        raise ValueError(f"diameter = {diameter!r}: must lie between 0 and 1, in edges of the box")
    if count is None:
        return max(1, round((0.2 if fraction is None else fraction) * 6 / (math.pi * diameter**3))), diameter
    return count, diameter if fraction is None else (6 * fraction / (math.pi * count)) ** (1 / 3)
