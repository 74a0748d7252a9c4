"""Write the benchmark: `python -m benchmark.make [NAME...]` makes scenes, checksums and the table of README.md anew.

Without names all of them, in some minutes; spheres that were drawn at random stay where the files have them.
"""

import hashlib
import json
import re
import sys
from pathlib import Path

import numpy as np

import benchmark
from benchmark.parts import labels, labels_at, table_of
from benchmark.recipes import arrays, dispersions, images, planes, transients
from benchmark.schema import faults
from demheat.io.known import label_digest

HOME = Path(benchmark.__file__).parent
FORMAT = "conduction-benchmark/1"
LICENCE = "CC0-1.0"
ALONG = 32
# Centres of voxels may move by this, in lengths of the box, and keep their material: the checksum is one of geometry.
SLIGHT = 1e-9
BEGIN, END = "<!-- table -->\n", "<!-- end of table -->"


def tables(wanted=()):
    """Tables of all files, or of those that are wanted."""
    for recipes in (arrays, planes, dispersions, transients):
        for name, made in recipes.entries():
            if not wanted or name in wanted:
                yield table(made())
    yield from (_headed(each) for each in images.tables() if not wanted or each["name"] in wanted)


def table(entry) -> dict:
    """What the file of an entry holds, with the image of its scene."""
    scene = {"scene": table_of(entry.scene)}
    painted = {"image": image(entry.scene)} if entry.scene.inclusions else {}
    words = {"name": entry.name, "group": entry.group, "title": entry.title}
    return _headed({**words, **scene, "known": entry.known, **painted})


def _headed(found):
    return {"format": FORMAT, "licence": LICENCE, **found}


def image(scene) -> dict:
    """Voxels of a scene's image, how many there are of each material, and the checksum of their labels."""
    size = np.array(scene.size)
    shape = tuple(int(n) for n in np.maximum(1, np.rint(size / size.max() * ALONG)))
    found = labels(scene, shape)
    middles = (np.stack(np.indices(shape), axis=-1).reshape(-1, 3) + 0.5) / shape * size
    for step in SLIGHT * size.max() * np.concatenate([np.eye(3), -np.eye(3)]):
        if np.any(labels_at(scene, middles + step) != found.ravel()):
            raise ValueError("an interface passes the centre of a voxel; must not, or rounding tells its material")
    return {"voxels": shape, "counts": np.bincount(found.ravel()).tolist(), "sha256": label_digest(found)}


def text_of(found: dict) -> str:
    """A table as JSON, vectors in one line."""
    text = json.dumps(found, indent=1, ensure_ascii=True, allow_nan=False)
    text = re.sub(r"\[\s+([^][{}]*?)\s+\]", lambda match: f"[{' '.join(match[1].split())}]", text)
    # An inclusion or a point in one line, too.
    text = re.sub(r"(?m)^ {3}\{\s+([^{}]*?)\s+\}", lambda match: f"   {{{' '.join(match[1].split())}}}", text)
    return re.sub(r"(?m)^ {4}\{\s+([^{}]*?)\s+\}", lambda match: f"    {{{' '.join(match[1].split())}}}", text) + "\n"


def page() -> str:
    """Rows of all scenes, as Markdown."""
    lines = ["| name | what | value | error | known by |", "|---|---|---|---|---|"]
    for name in benchmark.names():
        found = benchmark.read(name)
        known = found["known"]
        if "conductivity" in known:
            number = known["conductivity"]
            value, error = _digits(number["value"], number["error"]), f"{number['error']:.0e}, {number['error_is']}"
        else:
            points = known["fields"]["points"]
            value, error = f"{len(points)} temperatures", f"{known['fields']['temperature_error']:.0e} K"
        lines.append(f"| `{name}` | {found['title']} | {value} | {error} | {known['by']} |")
    return "\n".join(lines) + "\n"


def _digits(value, error):
    """The digits of a number that its error leaves, eleven at most."""
    return f"{value:.{min(11, max(0, int(-np.floor(np.log10(error)))))}f}"


def sums() -> str:
    """SHA-256 of the files, as `sha256sum --check SHA256SUMS` reads it."""
    paths = [HOME / "schema.json", *sorted(benchmark.FOLDER.glob("*.json"))]
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(HOME).as_posix()}\n" for path in paths
    )


def main(wanted=()) -> None:
    """Write the files; the arguments are names of scenes."""
    schema = json.loads((HOME / "schema.json").read_text(encoding="utf-8"))
    for found in tables(wanted):
        text = text_of(found)
        wrong = faults(json.loads(text), schema)
        if wrong:
            raise ValueError(f"{found['name']}: does not fit schema.json: {wrong}")
        (benchmark.FOLDER / f"{found['name']}.json").write_text(text, encoding="utf-8", newline="\n")
        print(found["name"], found["known"].get("conductivity", {}).get("value", ""), flush=True)
    readme = HOME / "README.md"
    before, _, rest = readme.read_text(encoding="utf-8").partition(BEGIN)
    readme.write_text(f"{before}{BEGIN}\n{page()}\n{END}{rest.partition(END)[2]}", encoding="utf-8", newline="\n")
    (HOME / "SHA256SUMS").write_text(sums(), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
