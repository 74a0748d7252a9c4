"""Lines of the tables: a scene with all methods, and a method over all scenes."""

import benchmark
from demheat.io.known import known_of
from studies.sphere_benchmark.cases import LADDERS
from studies.sphere_benchmark.means import finest, resolution_of, stepped, title_of


def by_scene(df):
    """|error| of each method at its finest, by scene."""
    import pandas as pd

    best = finest(df)
    names = [*LADDERS, *(name for name in df["name"].unique() if name not in LADDERS)]
    lines = []
    for scene in df["scene"].unique():
        rows, every = best[best["scene"] == scene].set_index("name"), df[df["scene"] == scene]
        line = {"scene": scene, "known": _known(scene)}
        for name in names:
            failed = every[(every["name"] == name) & every["status"].isin(("failed", "timeout"))]
            told = f"{abs(rows.loc[name, 'error_percent']):.2g}" if name in rows.index else "-"
            line[title_of(name)] = "!" if len(failed) and told == "-" else told
        lines.append(line)
    return pd.DataFrame(lines)


def by_method(df):
    """How many scenes a method answers at a resolution, its median and worst errors, and mean costs."""
    import pandas as pd

    real = stepped(df[~df["scene"].str.startswith("relation")])
    lines = []
    for (name, _), rows in real.groupby(["name", "place"], sort=False):
        good = rows[rows["status"] == "ok"]
        number, fluxes = good[good["known"].notna()], good["flux_percent"]
        lines.append(
            {
                "method": title_of(name),
                "resolution": resolution_of(rows.iloc[0]),
                "scenes": len(rows),
                "answered": len(good),
                "refused": int((rows["status"] == "unsupported").sum()),
                "failed": int(rows["status"].isin(("failed", "timeout")).sum()),
                "median error, %": number["error_percent"].abs().median(),
                "worst, %": number["error_percent"].abs().max(),
                "temperature, %": good["temperature_percent"].median(),
                "flux, %": fluxes.median(),
                "cpu_s": good["cpu_s"].median(),
                "peak_mib": good["peak_mib"].median(),
            }
        )
    return pd.DataFrame(lines)


def _known(scene):
    """What the file of a scene says, which rows that failed do not hold; empty of temperatures and relations."""
    if scene.startswith("relation "):
        return ""
    known = known_of(benchmark.read(scene)).conductivity
    return "" if known is None else f"{known:.8g}"
