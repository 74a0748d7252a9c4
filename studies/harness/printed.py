"""What the papers print, kept apart from how rows are stored: some rows compare themselves with it."""

import csv
from pathlib import Path


def printed(study):
    """Numbers that the paper prints for a study, {quantity: value}, from studies/paper/STUDY.csv."""
    with (Path(__file__).parents[1] / "paper" / f"{study}.csv").open(newline="", encoding="utf-8") as file:
        return {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
