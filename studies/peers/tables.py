"""What the rows of programs say: errors by body, what each costs, what each cannot do."""

from importlib import import_module

import pandas as pd

from studies.harness import methods
from studies.peers.beds import BEDS

# What is given, in the order of the table.
KINDS = {"image": "the image", "mesh": "our mesh", "body": "the body", "packing": "spheres", "network": "our matrix"}
KNOBS = {"n": "{:g}^3 voxels", "voxels": "{:g}^3 voxels", "size": "h = {:g}", "particles": "{:g} particles"}
# Knobs that choose among ways.
WAYS = ("by", "solver", "scheme", "gradient", "conforming", "density", "unit")
# Ours on beds of grains, and our linear solver: no methods.
GRAINS, SOLVER = "grains", "ours"
# Beds whose contacts conduct as discs between half-spaces do, which no program's own law is.
DISC = ", disc"
# What is asked of a program, and the bodies whose rows answer it.
ABILITIES = {
    "one phase": ("homogeneous",),
    "layers on the grid": ("layers across",),
    "layers off it": ("layers off the grid",),
    "sphere": ("sphere 10",),
    "contrast 0.01": ("sphere 0.01",),
    "contrast 1000": ("sphere 1000",),
    "pore": ("pore",),
    "narrow gaps": ("half 10",),
    "coat": ("coated",),
    "12 spheres": ("dispersion 10",),
    "grains, its law": tuple(name for name in BEDS if not name.endswith(DISC)),
    "grains, discs": tuple(name for name in BEDS if name.endswith(DISC)),
}
# At most one part in so many of the known value is shown as such: the rest is rounding.
NOTHING = 1e-9


def title(name):
    """How a method of ours, or a program of others, is called."""
    if name == GRAINS:
        return "demheat.grains"
    if name in methods.all_methods():
        return methods.all_methods()[name].title
    return import_module(f"studies.peers.programs.{name}").TITLE


def way(row):
    """How a program of others was asked to do it, where it knows several ways; empty for ours."""
    if row["name"] in methods.all_methods():
        return ""
    said = {knob: row[knob] for knob in WAYS if knob in row and row[knob] == row[knob] and row[knob] is not None}
    return ", ".join(value if isinstance(value, str) else f"{knob} {value}" for knob, value in said.items())


def ours(df):
    """True for rows of our own methods, (n,) bool Series."""
    return df["name"].isin([*methods.all_methods(), GRAINS, SOLVER])


def resolution(row):
    """What refines a row, in words."""
    words = [form.format(row[knob]) for knob, form in KNOBS.items() if knob in row and row[knob] == row[knob]]
    degree = (
        [f"degree {row['order']:g}"] if row["name"] not in methods.all_methods() and row.get("order", 0) > 0 else []
    )
    return ", ".join(words + degree)


def lines(df):
    """A line for each program and resolution, a column for each body: error of the conductivity, %; cost of one."""
    found = []
    df = df[~df["scene"].isin(BEDS)]
    records = df.to_dict("records")
    df = df.assign(resolution=[resolution(row) for row in records], way=[way(row) for row in records])
    for kind, words in KINDS.items():
        rows = df[df["given"] == kind]
        for (name, how, at), group in rows.groupby(["name", "way", "resolution"], sort=False):
            errors = {row["scene"]: _shown(row["error_percent"]) for _, row in group.iterrows()}
            cost = group[["cpu_s", "peak_mib", "unknowns"]].median()
            called = {"program": ", ".join(filter(None, [title(name), how])), "resolution": at}
            found.append({"given": words, **called, **errors, **cost})
    table = pd.DataFrame(found)
    last = [column for column in ("unknowns", "cpu_s", "peak_mib") if column in table]
    return table[[column for column in table if column not in last] + last]


def abilities(df):
    """A line for each program, ours too, a column for what may be asked: its best |error|, %.

    Of two bodies the worse one counts. "refused" is an answer; an empty place says that no row asks.
    """
    df = df[df["status"].isin(["ok", "unsupported"])]
    lines = []
    for (kind, name), rows in df.groupby(["given", "name"], sort=False):
        found = {what: _best(rows[rows["scene"].isin(bodies)]) for what, bodies in ABILITIES.items()}
        if any(found.values()):
            lines.append({"program": title(name), "given": KINDS[kind], **found})
    order = list(KINDS.values())
    return pd.DataFrame(sorted(lines, key=lambda line: (order.index(line["given"]), line["program"].lower())))


def _best(rows):
    """Best |error| of each body, the worst of these, in words."""
    done = rows[rows["status"] == "ok"]
    if len(done):
        worst = done["error_percent"].abs().groupby(done["scene"]).min().max()
        return f"{_shown(worst):.2g}"
    return "refused" if len(rows) else ""


def _shown(error):
    return 0.0 if abs(error) < NOTHING else error


def beds(df):
    """Sentences: how far programs are from what is known of beds of grains, by law and program."""
    rows = df[df["scene"].isin(BEDS)]
    if rows.empty:
        return
    mixed = rows["mixed"].eq(True) if "mixed" in rows else rows["scene"].eq("")
    for law, group in rows[~mixed].groupby(rows["scene"].map(lambda scene: BEDS[scene].law)):
        said = []
        for name, each in group.groupby("name"):
            said.append(f"{title(name)} {each['error_percent'].abs().max():.1e} % ({len(each)} beds)")
        yield f"Beds of grains, law '{law}', largest error: " + ", ".join(said) + "."


def sources(names):
    """A line for each program: what it is given and how it is installed."""
    modules = [import_module(f"studies.peers.programs.{name}") for name in names if name != SOLVER]
    rows = [{"program": m.TITLE, "given": KINDS[m.KIND], "from": m.GET} for m in modules]
    return pd.DataFrame(
        sorted(rows, key=lambda row: (list(KINDS.values()).index(row["given"]), row["program"].lower()))
    )


def cannot(names):
    """Sentences: what programs cannot do, by their own files."""
    for name in sorted(set(names) - {SOLVER}):
        module = import_module(f"studies.peers.programs.{name}")
        limits = "; ".join(f"{what}: {why}" for what, why in module.CANNOT.items())
        said = [f"cannot: {limits}" if limits else "", module.EXPLAINED]
        if any(said):
            yield f"**{module.TITLE}** ({module.GET}) " + ". ".join(filter(None, said))


def versions(df):
    """One sentence of the versions that ran."""
    pairs = df[["name", "version"]].dropna().drop_duplicates()
    said = [f"{title(name)} {version}" for name, version in pairs.itertuples(index=False) if version]
    return "Versions: " + ", ".join(said) + "." if said else ""
