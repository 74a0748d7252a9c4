"""Lines of the table of the study of fields among many spheres."""

from studies.common.paper_variants import parted, shown
from studies.fig18_fields.errors import BOUNDARIES, at_points, network_errors, network_means, witness
from studies.harness import methods
from studies.harness.figures import LOOK
from studies.harness.methods import resolution
from studies.harness.pick import pick

# Eyre and Milton's scheme has the voxels of the scalar one, whose fields stand for both.
COMPARED = tuple(method.name for method in methods.compared() if method.name != "fft-em")
SHOWN = {"T off": "worst_T", "q off": "worst_q", "T rms": "temperature_rms", "T max": "temperature_max",
         "flux rms": "flux_rms", "flux max": "flux_max", "band rms": "flux_rms_band", "band max": "flux_max_band",
         "unknowns": "unknowns", "elements": "elements"}  # fmt: skip

NETWORK = {"worst_T": "T off", "worst_q": "q off", "temperature_rms": "T rms", "flux_rms": "flux rms",
           "flux_rms_band": "band rms"}  # fmt: skip


def label(row):
    """Name of a row's method."""
    return LOOK[row["name"]][0]


def lines(df, found, paper):
    """Where the points lie; rows of each load, its witness first; what the paper prints."""
    place = pick(df, name="arrangement").iloc[0]
    blank = {"load": "", "method": "where the points lie", "resolution": ""}
    where = {f"T_{x}": place[f"phase_{x}"] for x in "ABCD"}
    where |= {f"q_{x}": f"{place[f'gap_{x}']:.3f} L off" for x in "ABCD"}
    made = [blank | where | dict.fromkeys(SHOWN, float("nan"))]
    for boundary in BOUNDARIES:
        truth, rows = witness(df, boundary), pick(found, boundary=boundary)
        if truth is None:
            continue
        first = rows["case"] == truth["case"]
        made += [_line(boundary, row) for part in (rows[first], rows[~first]) for _, row in part.iterrows()]
    for name, key in (("DE of the paper, 8e6 elements", "de"), ("FE of the paper, 2.3e6 tetrahedra", "fe")):
        printed = {f"{kind}_{x}": f"{paper[f'{kind}_{x}_{key}']:g}" for kind in "Tq" for x in "ABCD"}
        made.append(blank | {"method": name} | printed | dict.fromkeys(SHOWN, float("nan")))
    return made


def _line(boundary, row):
    line = {"load": boundary, "method": label(row), "resolution": resolution(row)}
    line |= {f"T_{x}": f"{row[f'T_{x}']:.3f}" for x in "ABCD"} | {f"q_{x}": f"{row[f'q_{x}']:.2f}" for x in "ABCD"}
    return line | {title: row[column] for title, column in SHOWN.items()}


def told(df, paper):
    """Sentences below the table, and the table of the network's variants where they have rows."""
    others = parted(df)[1]
    made = network_means(network_errors(df), tuple(NETWORK))
    best = (
        "; the best has the least error of the flux at its worst point. The particles' temperatures do not depend on "
        "C_t; what is read between them goes with their flux, that of the C_t found isothermally"
    )
    said = shown(
        made, NETWORK, "with halos of 11 mean radii, in all its variants: errors as above", best, among=["worst_q"]
    )
    place = pick(others, name="arrangement").iloc[0]
    gap = min(place[f"gap_{letter}"] for letter in "ABCD")
    said.append(f"The points of Table 3 lie {gap / place['band']:.2f} bands and more from any interface.")
    linear, truth = pick(others, name="fem-p1"), witness(others, "walls")
    if len(linear) and truth is not None:
        row = linear.loc[linear["elements"].idxmax()]
        said[-1] += (
            f" The linear elements are {row['elements'] / paper['tetrahedra']:.2f} times as many as the paper's; their "
            f"flux is {at_points(row, truth)['worst_q']:.2g} % off at the worst of them, where the paper's two methods "
            "differ by 3.1 %."
        )
    return said
