"""Intervals that methods give their conductivities, on scenes that laws are fitted to.

    python -m studies.frontier.halves

writes them to `halves.csv` beside this file, in some minutes; no cost is among them, so the machine need not be quiet.
"""

import csv
import sys
import tempfile
import warnings
from pathlib import Path

from demheat.cheapest.answers import half_of
from demheat.cheapest.cost_laws import predicted
from demheat.cheapest.loads import loads_of
from demheat.cheapest.ways import FIXED, HOMES, KNOBS, law_and_measures
from demheat.runtime.paths import replaced
from studies.common.searches.scenes import FOR_LAWS, STEADY, scene_of
from studies.harness import methods

FILE = Path(__file__).with_name("halves.csv")
# Values of each knob, sizes in edges of the box; processor seconds that a solve is expected to take at most.
VALUES = {
    "dem": ("particles", (1000, 2000, 4000, 8000, 16000, 32000)),
    "fem": ("size", (0.2, 0.14, 0.1, 0.07)),
    "fft": ("voxels", (24, 32, 48, 64, 96)),
    # From the degree that its own rise begins with.
    "multipole": ("order", (8, 10, 12, 14, 16, 20, 24, 28, 32)),
}
MOST_S = 4.0
COLUMNS = ("scene", "method", "value", "half")


def rows():
    """All intervals, relative, with the name of the scene, the method and its knob's value."""
    for scene in (*STEADY, *FOR_LAWS):
        for method, (knob, values) in VALUES.items():
            part = part_of(scene, method)
            try:
                law, m = law_and_measures(method, part)
            except NotImplementedError:
                # Other bodies than spheres.
                continue
            for value in values:
                value = value * m.edge if knob == "size" else value
                if predicted(law, m, value).cpu_s <= MOST_S and (row := _row(scene, part, method, knob, value)):
                    print(*row, flush=True)
                    yield row


def part_of(name, method):
    """What `effective` solves of a scene: the largest part that mirror planes leave, by multipoles the whole."""
    loads = loads_of(scene_of(name))
    return loads.largest if method in KNOBS else loads.body


def _row(scene, part, method, knob, value):
    knobs = {knob: value, **FIXED.get(method, {}), **({"allow_few": True} if method == "dem" else {})}
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        try:
            field = HOMES[method].solve(part, **knobs)
            half = half_of(field, method)
        except (NotImplementedError, RuntimeError, ValueError) as error:
            print(scene, method, value, " ".join(str(error).split())[:100], flush=True)
            return None
    return scene, method, f"{value:.6g}", f"{half / field.conductivity:.4g}"


def main():
    """Write all."""
    found = list(rows())
    with replaced(FILE) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(found)


if __name__ == "__main__":
    sys.exit(main())
