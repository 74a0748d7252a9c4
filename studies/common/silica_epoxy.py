"""Random dispersions of silica spheres in epoxy (section 5 of Haddad et al. 2021), and one solve of one as a row."""

from demheat.gallery import EDGE, EPOXY, SILICA
from studies.harness import methods
from studies.harness.cost import measured
from studies.harness.methods import resolution

RATIO = 6.0  # edge of the cube over the diameter
GAP = 0.02  # least distance of two surfaces, in diameters, if no other is asked for
SPREAD = 0.3  # of the radii of the unequal spheres, standard deviation over mean of the Gaussian before it is cut
# Table 3 of the paper, in edges of the cube; all four points lie on the plane x = L/2. Temperatures of its walls, C.
POINTS = {"A": (0.5, 0.6, 0.6), "B": (0.5, 0.02, 0.5), "C": (0.5, 0.3, 0.55), "D": (0.5, 0.82, 0.87)}
LOW, SPAN = 25.0, 10.0
KINDS = ("periodic", "walled", "unequal")
STATS = (
    *("unknowns", "iterations", "residual", "truncation", "smallest_gap", "elements"),
    *("packing_s", "tessellation_s", "network_s", "solve_s", "transform_s", "iteration_s"),
)


def scene(kind, fraction, *, seed, axis=1, boundary="gradient", gap=GAP):
    """Spheres of one kind in a cube: equal ones in a periodic cell or between walls, or unequal ones in a cell.

    Walled spheres, none of which crosses a face, can be under a mean gradient as well as between isothermal walls.
    """
    from demheat.packing.dispersion import dispersion_scene
    from demheat.packing.radii import Gaussian

    return dispersion_scene(
        fraction=fraction,
        ratio=RATIO,
        size=(EDGE, EDGE, EDGE),
        gap=gap,
        radii=Gaussian(SPREAD) if kind == "unequal" else None,
        periodic=kind != "walled",
        matrix=EPOXY,
        inclusion=SILICA,
        load=boundary,
        axis=axis,
        seed=seed,
    )


def solved(made, *, method, **knobs):
    """Solve a scene; return its Field and a row: k over the matrix's, the discrete fraction, statistics and cost."""
    field, cost = measured(methods.load(method).solve, made, **knobs)
    row = {"k_ratio": field.conductivity / EPOXY.conductivity, "inclusion": float(sum(field.fractions[1:]))}
    # "order" is a knob of finite elements.
    row |= {
        "number": len(made.inclusions),
        "degree": field.stats.get("order") if method == "multipole" else None,
    }
    return field, row | {name: field.stats.get(name) for name in STATS} | cost


def together(rows, axes):
    """One row of the solves along some axes: the mean of k and each one's; costs are sums, sizes those of the last."""
    row = dict(rows[-1]) | {f"k_{axis}": each["k_ratio"] for axis, each in zip(axes, rows, strict=True)}
    row["k_ratio"] = sum(each["k_ratio"] for each in rows) / len(rows)
    for name in ("wall_s", "cpu_s"):
        row[name] = sum(each[name] for each in rows)
    row["peak_mib"] = max(each["peak_mib"] for each in rows)
    return row


def words(row):
    """Resolution of a row; sizes as parts of the cube's edge."""
    refined = methods.all_methods()[row["name"]].resolution
    if refined and refined.metric:
        return f"h = L/{1 / methods.size_of(row):.0f}"
    return resolution(row).removesuffix(" voxels")
