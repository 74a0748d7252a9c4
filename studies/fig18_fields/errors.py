"""Errors of the rows of a study of fields against the witness of the same load, from their tables alone."""

import numpy as np

from demheat import referee
from studies.common.paper_network import calibrations
from studies.common.paper_variants import Variant, interval, parted
from studies.common.pictures import unpacked
from studies.fig18_fields.rows import POINTS, SPAN
from studies.harness.cells import picture
from studies.harness.pick import pick

BOUNDARIES = {"gradient": "periodic cell, mean gradient", "walls": "isothermal and insulated walls"}


def witness(df, boundary):
    """Row that the others of a load are held against: the multipoles of the highest degree, else the finest FEM."""
    rows = pick(df, boundary=boundary)
    exact = pick(rows, name="multipole")
    if len(exact):
        return exact.loc[exact["degree"].idxmax()]
    fem = pick(rows, name="fem")
    return fem.loc[fem["unknowns"].idxmax()] if len(fem) else None


def with_errors(df):
    """Rows of fields with their errors against the witness; that of the witness itself is 0."""
    import pandas as pd

    place = pick(df, name="arrangement")
    place = place.iloc[0] if len(place) else None
    rows = []
    for boundary in BOUNDARIES:
        truth = witness(df, boundary)
        for _, row in pick(df, boundary=boundary).iterrows():
            if truth is not None:
                rows.append(dict(row) | at_points(row, truth) | _over_plane(row, truth, _away(place, boundary)))
    return pd.DataFrame(rows)


def at_points(row, truth):
    """Errors of one row at the points, and the worst of each kind."""
    found = {}
    for letter in POINTS:
        found[f"T_{letter}_error"] = 100 * referee.value_error(row[f"T_{letter}"], truth[f"T_{letter}"], scale=SPAN)
        found[f"q_{letter}_error"] = 100 * referee.value_error(row[f"q_{letter}"], truth[f"q_{letter}"])
        pair = ([each[f"q{axis}_{letter}"] for axis in "xyz"] for each in (row, truth))
        found[f"vector_{letter}_error"] = 100 * float(referee.vector_error(*pair, scale=truth["mean_flux"]))
    for kind in ("T", "q", "vector"):
        found[f"worst_{kind}"] = max(abs(found[f"{kind}_{letter}_error"]) for letter in POINTS)
    # The paper's measure of a temperature, which depends on where its scale begins.
    degrees = [abs(referee.value_error(row[f"T_{letter}"], truth[f"T_{letter}"])) for letter in POINTS]
    return found | {"worst_celsius": 100 * max(degrees)}


def shown(row, name, *, fine=False):
    """Picture of a row: its temperature, % of the span, or a part of its flux, W/m2."""
    found = unpacked(row[f"fine_{name}"]) if fine else picture(row[f"slice_{name}"])
    # Of the paper's network, whose rows have C_t = 1.
    return found if name == "temperature" else found * row.get("factor", 1.0)


def error_pictures(row, truth, *, fine=False):
    """Error of the temperature, % of the span, and of the flux, size of the vector's in % of the mean flux."""
    # The pictures of temperature are in % of the span.
    warm = referee.value_error(*(shown(each, "temperature", fine=fine) for each in (row, truth)), scale=1.0)
    pair = (np.stack([shown(each, axis, fine=fine) for axis in "xyz"], axis=-1) for each in (row, truth))
    return warm, 100 * referee.vector_error(*pair, scale=truth["mean_flux"])


def network_errors(df):
    """Rows of the paper's network, one for each calibration, with their errors against the witness of their load."""
    import pandas as pd

    network, others = parted(df)
    place = pick(others, name="arrangement")
    place, made = (place.iloc[0] if len(place) else None), []
    for _, row in network.iterrows():
        truth = witness(others, row["under"])
        for way in calibrations(row["held"]) if truth is not None else ():
            one = _scaled(row, way)
            made.append(one | at_points(one, truth) | _over_plane(one, truth, _away(place, row["under"])))
    return pd.DataFrame(made)


def _scaled(row, way):
    """Row with fluxes in proportion to C_t."""
    factor = row[f"ct_{way}"]
    fluxes = [name for name in row.index if name[:2] in ("q_", "qx", "qy", "qz") or name == "mean_flux"]
    variant = Variant(row["packing"], row["held"], way)
    more = {"variant": variant, "factor": factor, "boundary": row["under"]}
    return dict(row) | {name: factor * row[name] for name in fluxes} | more


def network_means(found, columns):
    """Means over packings of errors of the network's variants, with intervals."""
    made = {}
    for (variant, number), rows in found.groupby(["variant", "particles"], sort=False) if len(found) else ():
        made[variant, int(number)] = {name: interval(rows[name].to_numpy(dtype=float)) for name in columns}
    return made


def _away(place, boundary):
    """Pixels farther than the band's width from interfaces and, between walls, insulated faces."""
    if place is None:
        return None
    gap = np.abs(picture(place["slice_gap"]))
    if boundary == "walls":
        gap = np.minimum(gap, picture(place["slice_face"]))
    return gap > place["band"]


def _over_plane(row, truth, away):
    warm, flux = error_pictures(row, truth)
    found = {"temperature_rms": referee.rms(warm), "temperature_max": float(np.abs(warm).max())}
    for ending, here in (("", away), ("_band", None if away is None else ~away)):
        part = flux if here is None else flux[here]
        found |= {f"flux_rms{ending}": referee.rms(part), f"flux_max{ending}": float(part.max())}
    return found
