"""A change of code accepted: rows whose values it moves are made again, old and new side by side.

Rows of a group (`groups.group_of`) of which one has moved get new values where they are others; their costs stay, as
those of the commit and the day on which they were measured. Rows that did not move are left alone. Of a group whose
cheapest row takes long the cheaper rows tell that the same code makes; all rows are looked at by `replay --all`, and
what that finds moved is made again here.
"""

import math
from itertools import chain

from demheat.runtime.rows import each_kept
from studies import contents
from studies.harness import replay, runner
from studies.harness.claims import judged
from studies.harness.groups import group_of
from studies.harness.sound import values_only
from studies.harness.store import MADE, TAIL, VALUES, add_rows, case_key, number_of, read_rows
from studies.harness.table import markdown, read_frame
from studies.harness.tolerance import COUNTED, moved, value_columns

# Seconds above which the cheapest row of a group is not looked at, where another's tells.
DEAR = 3.0


def accept(names, out, say):
    """Make again the rows of the groups that a replay finds moved, and say what that did to claims and values."""
    studies = {name: runner.load(name) for name in names if runner.csv_of(name, out).exists()}
    before = {name: _now(study, runner.csv_of(name, out)) for name, study in studies.items()}
    with replay.side_by_side() as compute:
        groups, made = replay.bear_out(studies, out, dear=DEAR, say=say, compute=compute)
        todo = [
            (name, study, case)
            for name, study in studies.items()
            for case in replay.stored_cases(study, runner.csv_of(name, out), unproved=True)
            if (name, group_of(study, case)) in groups
        ]
        say(f"{len(groups)} groups moved; {len(todo)} rows are made again")
        fresh, failed = _made_again(todo, made, out, say, compute)
    touched = [name for name in studies if any(task[0] == name for task in todo)]
    for name in touched:
        say(compared(name, studies[name], *before[name], out, fresh))
    return touched, failed


def _now(study, path):
    """Claims of a study as they are judged now, and its rows."""
    return judged(study, read_frame(study, path)), read_rows(path)


def _made_again(tasks, made, out, say, compute):
    """Put new values into stored rows as they come; the rows as made, by study and case, and those that were not."""
    fresh, failed = {}, []
    left = [task for task in tasks if (task[0], case_key(task[2])) not in made]
    have = [task for task in tasks if task not in left]
    rows = chain((made[task[0], case_key(task[2])] for task in have), compute(left))

    def keep(task, row):
        name, study, case = task
        path, key = runner.csv_of(name, out), case_key(case)
        if row["status"] not in runner.KEPT or replay.absent(row):
            # A row that there is must not give way to none.
            failed.append(f"{name} {key}: {row['status']}, {row['note']}")
            return failed[-1]
        stored = read_rows(path)[key]
        wrong = moved(name, study, case, stored, row)
        # One that is the same stays, to the last digit.
        other = wrong or any(column not in stored for column in value_columns(study, case, row))
        new = renewed(study, case, stored, row) if other else replay.stamped(stored, row, wrong)
        add_rows(path, {key: new}, replay.keys_of(study, path))
        fresh[name, key] = row
        return f"{name} {key}: {replay.moved_in_words(wrong)}"

    for number, words in enumerate(each_kept([*have, *left], enumerate(rows), keep, what="accept"), start=1):
        say(f"[{number}/{len(tasks)}] {words}")
    return fresh, failed


def renewed(study, case, stored, row):
    """A stored row with the values of a new one, and with its own costs."""
    # A column that the new row has no longer is empty; what is neither a value nor a cost (a note) is the new row's.
    old = {name: stored[name] for name in stored if name in TAIL and name not in COUNTED}
    costs = {name: stored[name] for name in stored if name not in TAIL and name not in _new_names(study, case, stored)}
    values = {name: row.get(name) for name in _new_names(study, case, [*stored, *row])}
    state = {name: row.get(name) for name in ("status", "note", "residual")}
    # What was said of the old values is not said of these.
    made = {f"values_{name}": row[name] for name in ("commit", "when", "machine")}
    state |= dict.fromkeys(VALUES, "") | made
    if values_only(study, case):
        # What a record takes: no cost of that day is asked for, and older code may have taken longer.
        state |= {name: row.get(name, "") for name in (MADE, "load")}
    return {**case, **costs, **values, **old, **state}


def _new_names(study, case, names):
    aside = [name for name in names if name not in TAIL and name.endswith(("note", "warning", "version", "remark"))]
    return [*value_columns(study, case, dict.fromkeys(names)), *aside]


def compared(name, study, claims, rows, out, fresh):
    """What new values did to a study, in Markdown: claims and groups of rows, old and new."""
    now = judged(study, read_frame(study, runner.csv_of(name, out)))
    return "\n\n".join([f"## {name}", *_claims(name, claims, now), _groups(name, study, rows, fresh)])


def _claims(name, before, now):
    import pandas as pd

    old = {claim.sentence: claim for claim in before}
    heads = [words for study, words in contents.HEADLINES if study == name]
    lines = []
    for claim in now:
        was = old.get(claim.sentence)
        if was is None or (str(was.value), was.verdict) == (str(claim.value), claim.verdict):
            continue
        lines.append(
            {
                "": "headline" if any(words in claim.sentence for words in heads) else "",
                "claim": claim.sentence,
                "old": f"{was.value:.4g}",
                "new": f"{claim.value:.4g}",
                "limit": claim.limit,
                "verdict": was.verdict if was.verdict == claim.verdict else f"{was.verdict} -> {claim.verdict}",
            }
        )
    return [markdown(pd.DataFrame(lines))] if lines else ["No claim has another value."]


def _groups(name, study, rows, fresh):
    """Errors and costs of each group, old and new; seconds of new rows are of two side by side, without a warm-up.

    Rows that are made for their values alone have none.
    """
    import pandas as pd

    lines = {}
    for case in study.CASES:
        row = fresh.get((name, case_key(case)))
        if row is not None:
            group = ", ".join(str(value) for _, value in group_of(study, case))
            lines.setdefault(group, []).append((rows[case_key(case)], row))
    table = []
    for group, pairs in lines.items():
        errors, seconds = (
            [[number_of(row, name) for row in side] for side in zip(*pairs, strict=True)]
            for name in ("error_percent", "cpu_s")
        )
        table.append(
            {
                "rows": group,
                "number": len(pairs),
                "worst |error|, %": _arrow(*(max(map(abs, side)) for side in errors)),
                "median |error|, %": _arrow(*map(_median, errors)),
                "CPU-s, measured -> beside others": _arrow(*map(sum, seconds)),
            }
        )
    return markdown(pd.DataFrame(table))


def _arrow(old, new):
    return f"{old:.3g} -> {new:.3g}" if math.isfinite(old + new) else ""


def _median(values):
    return sorted(map(abs, values))[len(values) // 2]
