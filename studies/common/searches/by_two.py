"""Conductivities of scenes that have no closed form, by what two methods close in on.

    python -m studies.common.searches.by_two

writes them to `by_two.csv` beside this file, in some minutes; a scene that is not there yet cannot be searched. The
conductivity is that of the method with the narrower interval; it may be off by what the two differ by, or by half of
that interval if that is more.
"""

import csv
import sys

from demheat import dem, referee
from demheat.runtime.paths import replaced
from references import fem
from studies.common.searches.scenes import scene_of
from studies.common.searches.truth import FILE

# What each method is given; edges in those of the box.
GIVEN = {
    "FEM": (fem, "size", 1 / 14),
    "DEM": (dem, "particles", 200_000),
}
SCENES = dict.fromkeys(
    ("ellipsoids", "unions", "gyroid", "ellipsoids at 50", "joined at 0.1", "primitive at 20"), ("FEM", "DEM")
)
COLUMNS = ("scene", "conductivity", "off", "by", "and", "other", "half")


def known(name: str) -> dict:
    """What two methods say of a scene."""
    found = sorted((_limit(name, each) for each in SCENES[name]), key=lambda each: each[1])
    (k, half, by), (other, _, beside) = found
    off = max(abs(referee.value_error(other, k)), half / k)
    return dict(zip(COLUMNS, (name, k, off, by, beside, other, half), strict=True))


def _limit(name, by):
    """Conductivity, half of its interval, and the method."""
    module, knob, value = GIVEN[by]
    scene = scene_of(name)
    field = module.solve(scene, **{knob: value * max(scene.size) if knob == "size" else value})
    try:
        found = field.extrapolated
    except (NotImplementedError, RuntimeError):
        found = field.error
    k = getattr(found, "conductivity", field.conductivity)
    print(
        f"{name} {by}: {field.conductivity:.8g}, {found.how} {k:.8g}, {found.lower:.8g} to {found.upper:.8g}",
        flush=True,
    )
    return k, 0.5 * (found.upper - found.lower), by


def main(names=None):
    """Write what is known of some scenes, or of all."""
    rows = {}
    if FILE.exists():
        with FILE.open(newline="", encoding="utf-8") as stream:
            rows = {row["scene"]: row for row in csv.DictReader(stream)}
    rows |= {name: known(name) for name in names or SCENES}
    with replaced(FILE) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[name] for name in SCENES if name in rows)


if __name__ == "__main__":
    main(sys.argv[1:])
