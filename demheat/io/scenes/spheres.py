"""Spheres of a scene from a table of their own: CSV, or a packing as LAMMPS, LIGGGHTS, YADE, OVITO and ASE write it."""

from demheat.io.scenes.shape_names import no_spheres
from demheat.io.scenes.sphere_tables import UNITS, read_table
from demheat.io.scenes.units import LENGTH, PLAIN, RESISTANCE, factor_of, scaled
from demheat.io.words import as_toml, nearest, nearest_file
from demheat.runtime.paths import checked_path
from demheat.scene import Sphere, Union

TABLES = (".csv", ".tsv", ".txt")
KEYS = dict.fromkeys(("file", "unit", "material", "radius_factor", "step", "join"), PLAIN)
KEYS |= {"offset": LENGTH, "resistance": RESISTANCE}
# Sides of a packing's box and the scene's differ by no more than this part: rounding of text in files.
SAME = 1e-6


def spheres_of(table, materials, default, size) -> list[tuple[Sphere | Union, str]]:
    """Spheres of an entry `file = ...`, each with the place where it stands; with `join` those that overlap as one.

    Coordinates of a packing count from the corner of its own box, which must be that of the scene unless an `offset`
    says where it lies; those of a file without a box count from the corner of the scene.
    """
    table.only(KEYS)
    path = checked_path(table.source.path.parent / table.text("file", ...))
    unit = table.text("unit", "m", among=UNITS)
    offset = table.vector("offset", LENGTH, (0.0, 0.0, 0.0))
    if len(offset) != 3:
        raise table.error(table.keys["offset"], f" = {as_toml(offset)}: must be three lengths")
    shrunk = table.number("radius_factor", PLAIN, 1.0)
    if not 0 < shrunk <= 1:
        raise table.error("radius_factor", f" = {as_toml(shrunk)}: must be a number > 0, at most 1")
    step = table.value("step", int, "an integer")
    factor = factor_of(unit, LENGTH)[0]
    tabular = path.suffix.lower() in TABLES
    if tabular and step is not None:
        raise table.error("step", f" = {step}: a table has one set of spheres; must be left out")
    _check_there(table, path)
    if tabular:
        rows, read_in = read_table(path, unit)
        rows = _within(rows, offset, size, read_in, largest=max(size) / shrunk, periodic=_is_cell(table))
    else:
        rows = _packed(table, path, factor, step, size)
    join, spheres = (
        table.value("join", bool, "true or false", False),
        _made(table, rows, materials, default, offset, shrunk),
    )
    if not join:
        return spheres
    from demheat.io.scenes.joined import joined  # SciPy

    return joined(spheres, size, periodic=_is_cell(table))


def _is_cell(table):
    """Whether the scene of a table is a periodic cell."""
    return any(key.startswith("gradient") for key in table.source.values)


def _within(rows, offset, size, read_in, *, largest, periodic):
    """The same rows; what is far from the box, and in a periodic cell a centre outside of it, is refused.

    That would come in again elsewhere, and mostly has another unit than it was read in.
    """
    for place, numbers, name in rows:
        center, radius = [c + d for c, d in zip(numbers, offset, strict=False)], numbers[3]
        room = SAME * max(size) if periodic else max(radius, 0.0)
        if any(c < -room or c > side + room for c, side in zip(center, size, strict=True)):
            cell = " x ".join(f"{side:.6g}" for side in size)
            raise ValueError(
                f"{place}: x y z = {', '.join(f'{c:.6g}' for c in center)} m: lies outside the "
                f"{'periodic cell' if periodic else 'box'}, 0 to {cell} m; must lie in it; {read_in(center, size)}"
            )
        if radius > largest:
            told = read_in([radius], size)
            raise ValueError(f"{place}: radius = {radius:.6g} m: must be at most {largest:.6g} m, as the box; {told}")
        yield place, numbers, name


def _check_there(table, path):
    if other := no_spheres(path):
        raise table.error("file", f" = {as_toml(table.values['file'])}: {other}")
    if not path.exists():
        told = f" = {as_toml(table.values['file'])}: there is no such file{nearest_file(path)}"
        raise table.error("file", told)


def _made(table, rows, materials, default, offset, shrunk):
    """Spheres of rows (place, centre and radius in metres, name of the material)."""
    found, resistance = [], table.number("resistance", RESISTANCE, 0.0)
    for place, numbers, name in rows:
        material = default if name is None else materials.get(name)
        if material is None and name is None:
            raise table.error("file", f": spheres of {place.partition(':')[0]} have no material; must be given here")
        if material is None:
            raise ValueError(f"{place}: material = {name!r}: must be one of [materials]{nearest(name, materials)}")
        center = tuple(c + d for c, d in zip(numbers, offset, strict=False))
        try:
            found.append((Sphere(center, numbers[3] * shrunk, material, resistance=resistance), place))
        except ValueError as error:
            if str(error).startswith("Sphere.resistance"):
                raise table.blamed(error) from None
            raise ValueError(f"{place}: {str(error).removeprefix('Sphere.')}") from None
    return found


def _packed(table, path, factor, step, size):
    """Rows of a packing; its reader says what is wrong with it."""
    from demheat.io.packings import read

    told = f" = {as_toml(table.values['file'])}"
    try:
        packing = read(path, step=step)
        if "box" in packing.provenance:
            # It has none: not that around its spheres, but that of the scene.
            sides = tuple(scaled(side, 1 / factor) for side in size)
            packing = read(path, step=step, size=sides, periodic=_is_cell(table))
    except OSError as error:
        raise table.error("file", f"{told}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise table.error("file", f"{told}: {error}") from None
    own = [scaled(side, factor) for side in packing.size.tolist()]
    if table.keys["offset"] is None and any(abs(a - b) > SAME * b for a, b in zip(own, size, strict=True)):
        box, wanted = (" x ".join(f"{side:.6g}" for side in sides) for sides in (own, size))
        valid = f"must be {wanted} m, as size is, by its unit, or have an offset"
        raise table.error("file", f"{told}: has a box of {box} m; {valid}")
    return _placed(path, packing, factor)


def _placed(path, packing, factor):
    for k, (center, radius) in enumerate(zip(packing.centers.tolist(), packing.radii.tolist(), strict=True)):
        yield f"{path}, sphere {k + 1}", [scaled(value, factor) for value in (*center, radius)], None
