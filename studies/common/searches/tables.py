"""Lines of the table: one scene each, a column for each target."""

from studies.common.searches import means
from studies.common.searches.scenes import SCENES
from studies.common.searches.search import TARGETS


def lines(df, quantity="conductivity", targets=TARGETS, among=SCENES):
    """The cheapest way for any shape to each accuracy, and the next."""
    import pandas as pd

    found = []
    known = {target: means.judged(df, quantity, target) for target in targets}
    for scene in means.scenes_of(df, among):
        cells = {
            f"{target:g} %": cell(means.best(df, scene, quantity, target)) if scene in known[target] else "?"
            for target in targets
        }
        found.append({"scene": means.starred(scene), **cells})
    return pd.DataFrame(found)


def cell(best):
    """Such as "FEM, degree 2: 0.23 s (next DEM, 2.1 times)"; "tie of FFT and DEM: 0.2 s"."""
    if best is None:
        return "-"
    tie = len(best.tied) > 1
    who = f"tie of {' and '.join(each.title for each in best.tied)}" if tie else best.first.title
    after = f" (next {best.next.title}, {best.next.cpu_s / best.first.cpu_s:.2g} times)" if best.next else ""
    return f"{who}: {best.first.cpu_s:.2g} s{after}"


def winners(df, quantity, targets):
    """How many scenes each method wins without a tie, a line for each accuracy, as a data frame."""
    import pandas as pd

    return pd.DataFrame([_line(df, quantity, target) for target in targets])


def _line(df, quantity, target):
    scenes = means.judged(df, quantity, target)
    every = {scene: means.best(df, scene, quantity, target) for scene in scenes}
    found = {scene: each for scene, each in every.items() if each is not None}
    cells = {means.TITLES[name].removeprefix("the "): _cell(*means.won_by(name, found)) for name in means.TITLES}
    tied, none = sum(len(each.tied) > 1 for each in found.values()), len(every) - len(found)
    return {"to": f"{target:g} % of the {quantity}", "scenes": len(scenes)} | cells | {"tie": tied, "none": none}


def _cell(won, others, bodies, factors):
    """Of it the bodies and how many are held back, and what the next method costs more."""
    if not won:
        return "0"
    head = f"{len(won)} ({bodies}, {others})"
    alone = f", alone on {len(won) - len(factors)}" if len(factors) < len(won) else ""
    return f"{head}: {means.between(factors)} times{alone}" if factors else f"{head}: alone"
