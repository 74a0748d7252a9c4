"""Which rows' costs count: those of a commit, measured while the machine was quiet; and how old rows are."""

import math
import re
from collections import Counter

from studies.harness.provenance import guest_case, of_this_code
from studies.harness.quiet import NOISY
from studies.harness.store import case_key, number_of, read_rows

DIRTY, NOISE = FAULTS = ("dirty", "noisy")
# Commits that are named.
MOST_COMMITS = 2
# Columns of costs, by their names: seconds, memory, speeds. A study's own `COSTS` are besides.
COSTS = re.compile(r".+_s|(\w+_)?(mib|gbs)|(\w+_)?us_per_\w+|(\w+_)?particle_steps")


def faults(row):
    """What is wrong with the costs of a row, in the order of FAULTS.

    Costs are measurements of a commit, a machine and a day, which stand in the row: they are no less so when the code
    has changed since.

    - dirty: its code was at no commit.
    - noisy: others used more than a tenth of the processors around it, or nobody knows, or it compiled kernels in
      more than a tenth of its time; only rows with costs are.
    """
    wrong = ("+" in str(row.get("commit")), math.isfinite(number_of(row, "cpu_s")) and not _quiet(row))
    return tuple(name for name, yes in zip(FAULTS, wrong, strict=True) if yes)


def _quiet(row):
    compiled, wall = number_of(row, "compile_s"), number_of(row, "wall_s")
    return number_of(row, "noise") <= NOISY and not compiled > NOISY * wall


def values_only(study, case):
    """Whether nobody asks what a row costs, by the study's `VALUES`: then it may be made beside another."""
    asked = getattr(study, "VALUES", False)
    return bool(asked(case)) if callable(asked) else asked


def uncosted(study):
    """Keys of the cases of a study whose values alone count."""
    return {case_key(case) for case in study.CASES if values_only(study, case)}


def counted(found):
    """How many rows have each fault."""
    count = Counter(name for each in found for name in each)
    return {name: count[name] for name in FAULTS}


def in_words(count):
    """Such numbers in words, as "0 dirty, 1 noisy"."""
    return ", ".join(f"{number} {name}" for name, number in count.items())


def checked(study, path):
    """Faults of all rows of a study's present cases in a file."""
    cases, spared = {case_key(case) for case in study.CASES}, uncosted(study)
    rows = {key: row | {"cpu_s": ""} if key in spared else row for key, row in read_rows(path).items()}
    return {key: faults(row) for key, row in rows.items() if key in cases or guest_case(study, key) is not None}


def proved(study, row):
    """Whether a row's values are those of the present code: it has made them, or made them again and found the same."""
    if moved_by_now(study, row):
        return False
    commits = (row.get("values_commit") or row.get("commit"), row.get("replayed_commit"))
    return any(of_this_code(str(commit or ""), study.__file__) for commit in commits)


def held(study, row):
    """Whether a run need not make a row: its values are proved, or another row's of its group are."""
    return proved(study, row) or (
        not moved_by_now(study, row) and of_this_code(row.get("borne_commit") or "", study.__file__)
    )


def moved_by_now(study, row):
    """Whether a replay by the present code found other values, which nobody has accepted yet."""
    return of_this_code(str(row.get("moved_commit") or ""), study.__file__)


def cost_columns(study, df):
    """Names of a data frame's, or of a row's, columns that hold costs."""
    own = getattr(study, "COSTS", ())
    return [name for name in df if name in own or COSTS.fullmatch(name)]


def total(found):
    """Rows of all chapters of a report, and those whose costs do not count, in words."""
    count = {name: sum(each.count[name] for each in found) for name in FAULTS}
    return f"{sum(each.rows for each in found)} rows: {in_words(count)}"


def ages(rows):
    """Of which commits rows are, most first, and when they were last replayed, in words."""
    rows = list(rows)
    count = Counter(str(row.get("values_commit") or row.get("commit") or "no commit") for row in rows)
    said = [f"{number} of {commit}" for commit, number in count.most_common(MOST_COMMITS)]
    said += [f"{len(count) - MOST_COMMITS} commits more"] if len(count) > MOST_COMMITS else []
    again = [row["replayed_when"] for row in rows if row.get("replayed_when")]
    last = f"{len(again)} replayed, last {max(again)[:10]}" if again else "none replayed"
    return f"{', '.join(said)}; {last}"
