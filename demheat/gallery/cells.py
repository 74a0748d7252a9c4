"""Cells of few shapes: slabs, laminates, one sphere, cubic arrays, a coated sphere; and the loads of all scenes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from demheat.scene import Layer, Material, Scene, Sphere
from demheat.scene.inputs import axis_number, chosen, finite, flag, vector, whole
from demheat.scene.material import check_material

# The cube of Haddad et al. 2021, section 4: a steel-like matrix, 0.1 m, 25 and 35 degrees C. (Their Table 1 prints a
# specific heat of 0.9 J/(kg K), a thousand times too small for a metal; it is kept so that their figures come out.)
HADDAD = Material(conductivity=33.0, density=7800.0, heat_capacity=0.9)
EDGE = 0.1
TEMPERATURES = (25.0, 35.0)
AXIS = 1


def slab(
    *,
    size: Sequence[float] = (EDGE, EDGE, EDGE),
    material: Material = HADDAD,
    periodic: bool = False,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
    """Homogeneous box.

    Parameters
    ----------
    size : (3,) sequence of float, m
    material : Material
    periodic, axis, temperatures
        As those of `loaded`, in all scenes here.
    """
    check_material("material", material)
    return Scene(size, material, **loaded(size, periodic, axis, temperatures))


def laminate(
    *,
    direction: str = "across",
    contrast: float = 5.0,
    layers: int = 2,
    edge: float = EDGE,
    matrix: Material = HADDAD,
    periodic: bool = False,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
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
    periodic, axis, temperatures
        As those of `loaded`.
    """
    chosen("direction", direction, ("across", "along"))
    whole("layers", layers, "an integer >= 1", lambda v: v >= 1)
    size = cube(edge, {"matrix": matrix})
    drive = loaded(size, periodic, axis, temperatures)
    normal = int(axis) if direction == "across" else (int(axis) + 1) % 3
    second, pitch = scaled(matrix, contrast), edge / layers
    # Centred in its period, so that no interface lies on a wall.
    painted = [Layer(normal, (i + 0.25) * pitch, (i + 0.75) * pitch, second) for i in range(layers)]
    return Scene(size, matrix, painted, **drive)


def sphere_in_cube(
    contrast: float = 5.0,
    *,
    radius: float | None = None,
    fraction: float | None = None,
    edge: float = EDGE,
    matrix: Material = HADDAD,
    periodic: bool = False,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
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
    periodic, axis, temperatures
        As those of `loaded`.
    """
    if radius is not None and fraction is not None:
        raise ValueError(f"radius = {radius!r}, fraction = {fraction!r}: give one of them, not both")
    size = cube(edge, {"matrix": matrix})
    if fraction is not None:
        radius = _radius(fraction, 1, edge)
    if radius is not None:
        finite("radius", radius, "a finite number > 0 m", lambda v: v > 0)
    sphere = Sphere((edge / 2,) * 3, edge / 3 if radius is None else radius, scaled(matrix, contrast))
    return Scene(size, matrix, [sphere], **loaded(size, periodic, axis, temperatures))


def simple_cubic(
    contrast: float = 10.0,
    *,
    fraction: float = 0.3,
    edge: float = EDGE,
    matrix: Material = HADDAD,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
    """Periodic cell of the simple cubic array, its sphere at the centre.

    Parameters
    ----------
    contrast : float
        Conductivity of the spheres over that of the matrix.
    fraction : float
        Volume fraction; spheres touch at pi/6 = 0.5236.
    edge : float, m
    matrix : Material
    axis, temperatures
        As those of `loaded`.
    """
    return _array([(0.5, 0.5, 0.5)], contrast, fraction, edge, matrix, axis, temperatures)


def body_centred(
    contrast: float = 10.0,
    *,
    fraction: float = 0.3,
    edge: float = EDGE,
    matrix: Material = HADDAD,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
    """Periodic cell of the body-centred cubic array, two spheres; they touch at 0.6802.

    Parameters
    ----------
    contrast, fraction, edge, matrix, axis, temperatures
        As those of `simple_cubic`.
    """
    sites = [(0.25, 0.25, 0.25), (0.75, 0.75, 0.75)]
    return _array(sites, contrast, fraction, edge, matrix, axis, temperatures)


def face_centred(
    contrast: float = 10.0,
    *,
    fraction: float = 0.3,
    edge: float = EDGE,
    matrix: Material = HADDAD,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
    """Periodic cell of the face-centred cubic array, four spheres; they touch at 0.7405.

    Parameters
    ----------
    contrast, fraction, edge, matrix, axis, temperatures
        As those of `simple_cubic`.
    """
    sites = [(0.25, 0.25, 0.25), (0.25, 0.75, 0.75), (0.75, 0.25, 0.75), (0.75, 0.75, 0.25)]
    return _array(sites, contrast, fraction, edge, matrix, axis, temperatures)


def coated_sphere(
    core: float = 165.0,
    shell: float = 16.5,
    *,
    radius: float = 0.3,
    core_fraction: float = 0.4,
    center: Sequence[float] = (0.5, 0.5, 0.5),
    edge: float = EDGE,
    periodic: bool = False,
    axis: int = AXIS,
    temperatures: Sequence[float] = TEMPERATURES,
) -> Scene:
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
    periodic, axis, temperatures
        As those of `loaded`.
    """
    finite("core_fraction", core_fraction, "a number between 0 and 1", lambda v: 0 < v < 1)
    finite("radius", radius, "a finite number > 0, in edges of the box", lambda v: v > 0)
    for name, value in (("core", core), ("shell", shell)):
        finite(name, value, "a finite number >= 0 W/(m K)", lambda v: v >= 0)
    size = cube(edge, {})
    k1, k2 = Material(shell).conductivity, Material(core).conductivity
    # The quotient above times (k2 + 2 k1), so that nothing divides by zero as long as one conductivity is not.
    weight = k2 + 2 * k1 - (k2 - k1) * core_fraction
    neutral = k1 * (k2 + 2 * k1 + 2 * (k2 - k1) * core_fraction) / weight if weight else 0.0
    middle = tuple(c * edge for c in vector("center", center))
    spheres = [
        Sphere(middle, radius * edge, Material(k1)),
        Sphere(middle, radius * edge * core_fraction ** (1 / 3), Material(k2)),
    ]
    return Scene(size, Material(neutral), spheres, **loaded(size, periodic, axis, temperatures))


def scaled(material: Material, contrast: float) -> Material:
    """The material with its conductivity multiplied by a contrast, all else kept.

    Parameters
    ----------
    material : Material
    contrast : float
        From 0; `math.inf` makes a perfect conductor of what conducts alike in all directions.
    """
    check_material("material", material)
    if contrast == math.inf and material.isotropic and material.conductivity > 0:
        return replace(material, conductivity=math.inf)
    finite("contrast", contrast, "a finite number >= 0, or math.inf of what conducts alike", lambda v: v >= 0)
    k = material.conductivity if material.isotropic else material.tensor
    return replace(material, conductivity=k * contrast)


def loaded(
    size: Sequence[float], periodic: bool = False, axis: int = AXIS, temperatures: Sequence[float] = TEMPERATURES
) -> dict[str, object]:
    """Load of a box, as keywords of `Scene`.

    Parameters
    ----------
    size : (3,) sequence of float, m
    periodic : bool
        A periodic cell; else two opposite walls are held at a temperature and the other four faces are insulated.
    axis : {0, 1, 2}
        Of the load.
    temperatures : (2,) sequence of float, K or degrees Celsius
        Of its low and its high wall. In a periodic cell their difference over the length of the box is the mean
        gradient, so both loads drive the same mean flux.
    """
    size, axis = vector("size", size), axis_number(axis)
    low, high = vector("temperatures", temperatures, length=2)
    if flag("periodic", periodic):
        gradient = [0.0, 0.0, 0.0]
        gradient[axis] = (high - low) / size[axis]
        return {"gradient": gradient}
    return {"walls": {"xyz"[axis] + "-": low, "xyz"[axis] + "+": high}}


def cube(edge: float, materials: Mapping[str, Material]) -> tuple[float, float, float]:
    """Sides of a cube, when its edge and its materials are what they should be."""
    finite("edge", edge, "a finite number > 0 m", lambda v: v > 0)
    for name, material in materials.items():
        check_material(name, material)
    return (edge,) * 3


def _radius(fraction, spheres, edge):
    finite("fraction", fraction, "a finite number > 0", lambda v: v > 0)
    return edge * (3 * fraction / (4 * math.pi * spheres)) ** (1 / 3)


def _array(sites, contrast, fraction, edge, matrix, axis, temperatures):
    size = cube(edge, {"matrix": matrix})
    radius, material = _radius(fraction, len(sites), edge), scaled(matrix, contrast)
    spheres = [Sphere(tuple(c * edge for c in site), radius, material) for site in sites]
    return Scene(size, matrix, spheres, **loaded(size, True, axis, temperatures))
