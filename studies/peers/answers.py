"""Answers of programs that others wrote to scenes of the benchmark, as files that `demheat judge` reads.

`python -m studies.peers.answers` writes `benchmark/answers/` from the stored rows of this study: nothing is computed.
"""

import json
from pathlib import Path

import benchmark
from demheat.io.answers import FORMAT
from studies.harness import runner
from studies.harness.table import read_frame
from studies.peers import PROGRAMS, tables
from studies.peers.given import scene

STUDY, ROOT = "peers", Path(__file__).parents[2]
ANSWERS = benchmark.FOLDER.parent / "answers"
# Bodies of the study that stand among the scenes of the benchmark.
SAME = {
    "layers off the grid": "laminate-off-grid",
    "sphere 10": "sc-third-s10",
    "sphere 0.01": "sc-third-s0.01",
    "pore": "sc-third-pore",
    "half 10": "sc-f50-s10",
    "coated": "coated-s10",
}
# Of these bodies a program must have answered so many.
FEWEST = 5
GIVEN = {"image": "the image of a body, each voxel of one material", "body": "the body itself", "mesh": "our mesh"}
# Columns of rows, and what the files call them; empty where they were measured in noise.
COSTS = {"cpu_s": "cpu_s", "wall_s": "wall_s", "peak_mib": "memory_mib"}


def files(path=ROOT / "results" / f"{STUDY}.csv") -> dict[str, str]:
    """Text of each file by its name, from the rows of a CSV."""
    df = read_frame(runner.load(STUDY), path)
    df = df[df["scene"].isin(SAME) & df["given"].isin(GIVEN) & df["name"].isin(PROGRAMS)]
    found = {}
    for name, rows in df.groupby("name"):
        answered = rows[rows["status"] == "ok"]
        if answered["scene"].nunique() >= FEWEST:
            found[f"{name}.json"] = _text(name, answered, rows)
    return found


def _text(name, answered, rows):
    given = " or ".join(GIVEN[kind] for kind in rows["given"].unique())
    head = {
        "format": FORMAT,
        "program": tables.title(name),
        "version": str(answered["version"].iloc[0]),
        "method": f"given {given}; as users run it, see docs/peers.md",
        "machine": ", ".join(sorted(set(answered["machine"]))),
    }
    answers = [_answer(row) for row in rows.to_dict("records")]
    lines = ",\n  ".join(json.dumps(each, ensure_ascii=False) for each in answers)
    text = json.dumps(head, indent=1, ensure_ascii=False).removesuffix("\n}")
    return f'{text},\n "answers": [\n  {lines}\n ]\n}}\n'


def _answer(row):
    knobs = [words.format(row[knob]) for knob, words in tables.KNOBS.items() if row.get(knob) == row.get(knob)]
    degree = [f"degree {row['order']:g}"] if row["order"] == row["order"] else []
    told = {"scene": SAME[row["scene"]], "resolution": ", ".join(filter(None, [*knobs, *degree, tables.way(row)]))}
    if row["status"] != "ok":
        return told | {"refused": row["note"]}
    costs = {name: float(f"{row[column]:.6g}") for column, name in COSTS.items() if row[column] == row[column]}
    return told | {"conductivity": row["conductivity"], **costs, "unknowns": int(row["unknowns"])}


def main():
    """Write the files; those of programs that answer too little are taken away."""
    ANSWERS.mkdir(exist_ok=True)
    for path in ANSWERS.glob("*.json"):
        path.unlink()
    for name, text in files().items():
        (ANSWERS / name).write_text(text, encoding="utf-8")
        print(ANSWERS / name)
    differ = [ours for ours, theirs in SAME.items() if scene(ours) != benchmark.load(theirs)[0]]
    if differ:
        raise SystemExit(f"not the scenes of the benchmark: {', '.join(differ)}")


if __name__ == "__main__":
    main()
