"""Errors against costs: what each program makes of a body, and what that takes."""

from studies.harness import methods
from studies.harness.figures import look
from studies.peers.means import PARTS
from studies.peers.tables import ours, title

PANELS = ("sphere 10", "half 10", "pore", "dispersion 10")
# What is exact is drawn at the edge, %.
LEAST = 1e-6
MARKERS = "o^sDvP*X<>phd"
STYLES = {"image": "-", "mesh": "--", "body": "-.", "network": ":"}


def plot(df):
    """Errors against costs on four bodies; of each program what no other of its own rows beats."""
    df = df[df["status"] == "ok"]
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(2, 2, figsize=(12, 9), sharex=True, sharey=True)
    df = df[~df["given"].isin(PARTS)]
    others = sorted(set(df.loc[~ours(df), "name"]))
    colours = {name: pyplot.get_cmap("tab20")(number % 20) for number, name in enumerate(others)}
    for axes, scene in zip(panels.flat, PANELS, strict=True):
        rows = df[df["scene"] == scene]
        for (name, kind), group in rows.groupby(["name", "given"]):
            group = front(group)
            # A method of ours has one look; what it is given tells its line.
            how = _ours(name) if name in methods.all_methods() else _theirs(name, others.index(name), colours[name])
            label = {"label": f"{how.pop('label')}, {kind}"}
            axes.plot(group["cpu_s"], group["error_percent"].abs().clip(lower=LEAST), **how | label)
        axes.set(xscale="log", yscale="log", title=scene)
    for axes in panels[1]:
        axes.set_xlabel("CPU time, s")
    for axes in panels[:, 0]:
        axes.set_ylabel("|error| of the conductivity, %")
    named = {}
    for axes in panels.flat:
        named |= dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    figure.legend(named.values(), named.keys(), loc="outside right upper", fontsize=8)
    figure.suptitle("Programs of others beside ours (thick)")
    return figure


def front(rows):
    """Rows that no other beats in error and cost at once, by rising cost."""
    rows = rows.sort_values("cpu_s")
    error = rows["error_percent"].abs()
    return rows[error < error.cummin().shift(fill_value=float("inf"))]


def _ours(name):
    return look(name, linewidth=2.6, markersize=7, label=title(name))


def _theirs(name, number, colour):
    marker = MARKERS[number % len(MARKERS)]
    return {"label": title(name), "color": colour, "marker": marker, "linewidth": 1.0, "markersize": 5}
