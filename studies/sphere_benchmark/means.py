"""What is claimed of the rows, and rows of one method brought together."""

import numpy as np

import benchmark
from studies.sphere_benchmark.cases import GUEST, LADDERS, RELATIONS

# At the finest resolution, median and worst error of conductivities, %; patterns of squares have corners at which
# fluxes are infinite, and no limit. Before rows were there: .5 and 10, .2 and 5, 1 and 10, .01 and 1; brought nearer
# to those that were more than three times what came out.
LIMITS = {"dem": (0.007, 0.6), "fem": (0.07, 0.7), "fft": (0.2, 10.0), "multipole": (1.5e-4, 1.0)}
# What a relation may be broken by: rounding where nothing else changes, else the error of the method; before rows were
# there 1e-4, 1e-4, 1e-3, 2 and .1.
KEPT = {"uniform": 1e-10, "scaled": 1e-10, "reversed": 1e-10, "turned": 0.075, "tenfold": 0.0085}


# Columns of rows that went well: of a method that fails or refuses everywhere there are none.
FOUND = ("known", "error_percent", "temperature_percent", "flux_percent")


def whole(df):
    """The rows with all columns, empty where no row has them."""
    return df.reindex(columns=[*df.columns, *(name for name in FOUND if name not in df)])


def all_claims(df):
    """Pairs of a sentence with a value and a limit."""
    yield from [_files(df), *_errors(df), *_relations(df)]


def _files(df):
    rows = df[df["known"].notna()]
    now = {name: benchmark.known_of(benchmark.read(name)).conductivity for name in set(rows["scene"])}
    other = sum(row["known"] != now[row["scene"]] for row in rows.to_dict("records"))
    return "Rows whose known value is not that of the file", float(other) if len(rows) else None, "= 0"


def _errors(df):
    for name, (middle, worst) in LIMITS.items():
        rows = finest(df[(df["name"] == name) & df["known"].notna()])
        rows = rows[~rows["scene"].str.contains("checkerboard|square-rods")]
        errors = rows["error_percent"].abs()
        if len(rows) < 5:
            continue
        yield f"{name}, finest, but for patterns of squares: median error of conductivities, %", errors.median(), middle
        yield (
            f"{name}, finest, but for patterns of squares: worst error of conductivities, %",
            errors.max(skipna=False),
            worst,
        )


def _relations(df):
    good = df[(df["status"] == "ok") & (df["name"].isin(list(LADDERS)))]
    for relation in RELATIONS:
        rows = good[good["scene"] == f"relation {relation}"]
        worst = rows["error_percent"].abs().max(skipna=False) if len(rows) else None
        yield f"relation {relation}, any method: broken by, %", worst, KEPT[relation]


def step_of(row) -> float:
    """Place of a row on its method's ladder: the larger the finer."""
    if row["method"] == GUEST:
        return row["step"]
    column, values = LADDERS[row["name"]]
    return 0 if column is None else values.index(row[column])


def stepped(df):
    """The rows with their `place` on the ladders."""
    return df.assign(place=np.array([step_of(row) for row in df.to_dict("records")], dtype=float))


def finest(df):
    """Of each method and scene the finest row that went well."""
    rows = stepped(df[df["status"] == "ok"]).sort_values("place", kind="stable")
    return rows.groupby(["name", "scene"], sort=False).tail(1)


def title_of(name) -> str:
    """A method in words; a guest by the last part of its name."""
    from studies.harness import methods

    found = methods.all_methods().get(name)
    return found.title if found else name.rsplit("/", 1)[-1].rsplit(".", 1)[-1]


def resolution_of(row) -> str:
    """Resolution of a row in words."""
    from studies.harness import methods

    if row["method"] == GUEST:
        return f"step {row['step']:.0f}"
    column, _ = LADDERS[row["name"]]
    return "" if column is None else methods.all_methods()[row["name"]].resolution.words.format(row[column])
