"""The table of fields inside a sphere and around it: methods, and what the paper prints."""

from demheat import referee
from studies.harness.cells import numbers
from studies.harness.methods import resolution
from studies.harness.pick import pick, with_size

PRINTED = {"DE, 1.5e5": "150k", "DE, 5e5": "500k", "FE, 1e5 tetrahedra": "fe"}
ERRORS = {"flux_rms": "flux rms", "flux_max": "max", "flux_rms_band": "band rms", "flux_max_band": "band max",
          "flux_rms_own": "own rms", "flux_max_own": "own max", "temperature_rms": "T rms", "temperature_max": "T max",
          "own_temperature_rms": "T own points", "relative_temperature": "dT/T max", "relative_flux": "dq/q max",
          "relative_within": "within 19.6 %"}  # fmt: skip
COSTS = {"unknowns": "unknowns"}


def lines(df, paper, points):
    """Table as a data frame."""
    import pandas as pd

    exact = pick(df, name="exact").iloc[0]
    rows = [_line(label(group.iloc[0]), group, points) for _, group in _grouped(df)]
    rows += [_printed(f"paper's {what}", key, exact, paper, points) for what, key in PRINTED.items()]
    return pd.DataFrame(rows)


def largest(rows, columns):
    """Largest size in some columns of rows; None without rows."""
    return rows[columns].abs().max(axis=1, skipna=False).max(skipna=False) if len(rows) else None


def error_columns(kind, points):
    """Columns of the errors at the points, of "T" or of "q"."""
    return [f"{kind}_{letter}_error" for letter in points]


def _grouped(df):
    return with_size(df[df["status"] == "ok"]).groupby(["name", "ratio", "h"], dropna=False, sort=False)


def label(row):
    """What a row is, without its resolution."""
    names = {
        "dem": "DEM, Laguerre",
        "dem-plain": "DEM, Laguerre, not conforming",
        "fem": "FEM, P2",
        "fem-p1": "FEM, P1",
    }
    names |= {"fft": "FFT", "exact": "exact"}
    return names.get(row["name"]) or f"DEM as in the paper, halo of {row['ratio']:.3g} radii"


def over_plane(df):
    """Errors over the plane, a line for each method and resolution."""
    return _means(df, ERRORS)


def costs(df):
    """Costs, a line for each method and resolution."""
    return _means(df, COSTS)


def _means(df, columns):
    import pandas as pd

    found = []
    for _, group in _grouped(df):
        mean = group.mean(numeric_only=True)
        line = {"method": label(group.iloc[0]), "resolution": resolution(group.iloc[0])}
        found.append(line | {title: mean.get(column, float("nan")) for column, title in columns.items()})
    return pd.DataFrame(found)


def in_words(df, paper):
    """What the fluxes of Table 2 say of the paper's halos, as sentences."""
    exact = pick(df, name="exact").iloc[0]
    off = {n: f"{100 * referee.value_error(paper[f'q_C_{n}'], exact['q_C']):+.1f} %" for n in ("150k", "500k")}
    yield (
        f"The printed flux at C is {off['150k']} off the exact one with 1.5e5 elements and {off['500k']} with 5e5: no "
        "noise, which would fall."
    )
    if isinstance(exact.get("halo_radius"), str):
        yield _of_smoothing(exact, paper)
    network = pick(df, name="dem-calibrated", seed=0).sort_values("particles")
    same, most = network[~network["ratio"].isin((4.0, 11.0))], pick(network, particles=500_000, ratio=11.0)
    if len(same) and len(most):
        yield _of_size(same, most.iloc[0], paper)


def _of_smoothing(exact, paper):
    """The exact field averaged over the paper's halo, at B and C."""
    place, said = numbers(exact["halo_radius"]).tolist().index(0.103), []
    for letter in "BC":
        mean = numbers(exact[f"halo_q_{letter}"])[place]
        off = 100 * referee.value_error(mean, exact[f"q_{letter}"])
        said.append(f"{mean:.0f} at {letter} ({off:+.1f} %; printed {paper[f'q_{letter}_150k']:.0f})")
    return (
        f"The exact flux averaged over halos of .103 L, 11 mean radii of 1.5e5 particles, is {' and '.join(said)}: "
        "smoothing accounts for B and not for C. C is .08 L below a wall with a temperature; a halo as wide reaches "
        "the particles at the wall, whose flux by eq. 20 lacks their links to it (study fig10_halo)."
    )


def _of_size(same, most, paper):
    """Halos of a size in mean radii beside those of a size in metres."""
    found = ", ".join(f"{row['q_C']:.0f} with {row['particles']:.0f}" for _, row in same.iterrows())
    last = same.iloc[-1]
    return (
        f"With 5e5 particles a halo of 11 radii, .069 L, ends before that wall: ours gives {most['q_C']:.0f} at C, the "
        f"paper {paper['q_C_500k']:.0f}. Halos as wide in metres as with 1.5e5 particles reach it: {found} particles; "
        f"at B {last['q_B']:.0f} with {last['particles']:.0f}, printed {paper['q_B_500k']:.0f}."
    )


def _line(name, group, points):
    mean = group.mean(numeric_only=True)
    line = {"method": name, "resolution": resolution(group.iloc[0])}
    line |= {f"T_{letter}": f"{mean[f'T_{letter}']:.3f}" for letter in points}
    line |= {f"q_{letter}": mean[f"q_{letter}"] for letter in points}
    return line | {"worst q, %": largest(group, error_columns("q", points))}


def _printed(name, key, exact, paper, points):
    line = {"method": name, "resolution": ""}
    line |= {f"T_{letter}": f"{paper[k]:g}" if (k := f"T_{letter}_{key}") in paper else "" for letter in points}
    line |= {f"q_{letter}": paper[f"q_{letter}_{key}"] for letter in points}
    off = [referee.value_error(paper[f"q_{letter}_{key}"], exact[f"q_{letter}"]) for letter in points]
    return line | {"worst q, %": 100 * abs(referee.worst(off)[1])}
