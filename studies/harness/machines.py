"""Which machines rows come from: seconds of different ones never stand on one curve."""

import math
from collections import Counter

from studies.harness.quiet import NOISY


def origins(rows):
    """Which machine each row is from; one of unknown host is taken for the only other of its model, if there is one."""
    pairs = [(_text(row.get("machine")), _text(row.get("host"))) for row in rows]
    hosts = {}
    for model, host in pairs:
        hosts.setdefault(model, set()).update({host} - {""})
    return [f"{model} {host or ''.join(hosts[model] if len(hosts[model]) == 1 else ())}" for model, host in pairs]


def of_one_machine(df):
    """The rows, without the seconds of other machines than the one that made most of their part."""
    timings = [name for name in df if name in ("cpu_s", "wall_s") or name.endswith(("_cpu_s", "_wall_s"))]
    found, parts = origins(df.to_dict("records")), df["part"].astype(str) if "part" in df else [""] * len(df)
    timed = df[timings].notna().any(axis=1)
    made = {part: Counter() for part in parts}
    for part, origin, seconds in zip(parts, found, timed, strict=True):
        made[part][origin] += bool(seconds)
    chosen = [origin == made[part].most_common(1)[0][0] for part, origin in zip(parts, found, strict=True)]
    return df if all(chosen) else df.assign(**{name: df[name].where(chosen) for name in timings})


def said(df):
    """What a page says of the machines of its rows, a list of sentences; empty if there is nothing to say."""
    lines, count = [], len(set(origins(df.to_dict("records"))))
    if count > 1:
        lines.append(f"rows are from {count} machines: seconds of all but the one that made most are left out")
    if crowded := _crowded(df):
        lines.append(f"{crowded} rows ran beside others on their machine: alone they would have cost less")
    return lines


def _crowded(df):
    """How many rows ran beside others; what was counted where nobody used a tenth of the processors was dead."""
    if "beside" not in df:
        return 0
    alone = df["noise"] <= NOISY if "noise" in df else False
    return int(((df["beside"] > 0) & ~alone).sum())


def _text(value):
    return "" if value is None or (isinstance(value, float) and math.isnan(value)) else str(value)
