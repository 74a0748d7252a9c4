"""Who may import whom: the rooms of the house, and the one home of each library."""

import pytest
from imported import HOMES, MODULES, OURS, below, imports

# The rooms of the house from the ground up, and what each may import of ours: itself and rooms that stand before it.
# The longest prefix that fits a module is its room; a prefix stands for itself and all below it. A module adds a line.
LAYERS = {
    "demheat.scene.inputs": (),
    "demheat.scene.frozen": (),
    "demheat.scene.bodies": (),
    "demheat.scene.crossing": ("demheat.scene.bodies",),
    "demheat.scene.dependence": ("demheat.scene.inputs",),
    "demheat.scene.rotations": ("demheat.scene.inputs",),
    "demheat.scene.tensors": ("demheat.scene.inputs", "demheat.scene.rotations"),
    "demheat.scene.material": ("demheat.scene.inputs", "demheat.scene.dependence", "demheat.scene.tensors"),
    "demheat.scene.image": ("demheat.scene.frozen", "demheat.scene.inputs", "demheat.scene.material"),
    "demheat.scene.shapes": (
        "demheat.scene.inputs",
        "demheat.scene.rotations",
        "demheat.scene.material",
        "demheat.scene.shapes",
    ),
    "demheat.scene.parts": ("demheat.scene.inputs",),
    "demheat.scene.checks": (
        "demheat.scene.frozen",
        "demheat.scene.crossing",
        "demheat.scene.image",
        "demheat.scene.inputs",
        "demheat.scene.bodies",
        "demheat.scene.parts",
        "demheat.scene.shapes",
    ),
    "demheat.scene.needs": ("demheat.scene.parts",),
    "demheat.scene.functions": ("demheat.scene.inputs", "demheat.scene.parts"),
    "demheat.scene.html": (),
    "demheat.scene.scene": (
        "demheat.scene.html",
        "demheat.scene.image",
        "demheat.scene.inputs",
        "demheat.scene.bodies",
        "demheat.scene.dependence",
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
    "demheat.vtk": (),
    "demheat.paths": (),
    "demheat.machine": (),
    "demheat.fresh": (),
    "demheat.cluster": (),
    "demheat.compiled": ("demheat.progress",),
    "demheat.method": (),
    "demheat.referee": ("demheat.referee", "demheat.scene", "demheat.field"),
    "demheat.slices": ("demheat.scene", "demheat.field", "demheat.limits"),
    # Nouns know nothing of those who draw them: `plot` loads this by its name.
    "demheat.pictures": ("demheat.scene", "demheat.field", "demheat.slices"),
    "demheat.packing": (
        "demheat.addition",
        "demheat.scene",
        "demheat.threads",
        "demheat.blocks",
        "demheat.progress",
        "demheat.compiled",
        "demheat.limits",
        "demheat.vtk",
        "demheat.paths",
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
    "demheat.damage": (
        "demheat.scene",
        "demheat.field",
        "demheat.laws",
        "demheat.progress",
        "demheat.packing",
        "demheat.network",
        "demheat.conduction",
        "demheat.sampling",
        "demheat.build",
        "demheat.dem",
        "demheat.damage",
    ),
    # What methods cost and how far they are off, and the cheapest of them: it loads a method by its name alone.
    "demheat.cheapest": (
        "demheat.scene",
        "demheat.tensor",
        "demheat.limits",
        "demheat.method",
        "demheat.cheapest",
    ),
    # One function over many cases: of what it returns it knows a Field and the tensor of `effective`.
    "demheat.sweeps": (
        "demheat.scene",
        "demheat.field",
        "demheat.paths",
        "demheat.progress",
        "demheat.machine",
        "demheat.fresh",
        "demheat.cluster",
        "demheat.cheapest.effective",
        "demheat.sweeps",
    ),
    # Finds methods where they are declared: by name alone, as the cheapest does.
    "demheat.declared": ("demheat.method",),
    "demheat.files": (
        "demheat.scene",
        "demheat.field",
        "demheat.vtk",
        "demheat.paths",
        "demheat.laws",
        "demheat.limits",
        "demheat.method",
        "demheat.packing.io",
        "demheat.declared",
        "demheat.files",
    ),
    # A model of its own, by the engine's packings and solver: beds of grains out of files.
    "demheat.grains": (
        "demheat.paths",
        "demheat.scene",
        "demheat.packing",
        "demheat.network.base",
        "demheat.conduction.steady",
        "demheat.sampling.fluxes",
        "demheat.grains",
    ),
    # The commands of the terminal, on top of all.
    "demheat.commands": (
        "demheat.scene",
        "demheat.field",
        "demheat.laws",
        "demheat.method",
        "demheat.slices",
        "demheat.paths",
        "demheat.pictures",
        "demheat.cheapest",
        "demheat.declared",
        "demheat.files",
        "demheat.commands",
    ),
    # A big solve on several processes: the engine's own parts at work on slabs, and a command of its own.
    "demheat.mpi": (
        "demheat.scene",
        "demheat.field",
        "demheat.laws",
        "demheat.limits",
        "demheat.threads",
        "demheat.packing",
        "demheat.network",
        "demheat.conduction",
        "demheat.sampling",
        "demheat.build",
        "demheat.dem",
        "demheat.mpi",
    ),
    "demheat.mpi.__main__": ("demheat.files", "demheat.commands.options", "demheat.mpi"),
    "demheat.__main__": ("demheat.commands",),
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
        "demheat.sweeps",
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
    "references.bracket.voxels": (
        "demheat.scene",
        "demheat.limits",
        "demheat.process_state",
        "demheat.progress",
        "references.threads",
        "references.voxels",
        "references.fft",
        "references.bracket",
    ),
    # Old names of what lies in folders now.
    "references.series": ("references.exact.series",),
    "references.zeta": ("references.fft.zeta",),
    "references": (),
    # Scenes with known answers: what reads them knows the nouns, what made them the witnesses.
    "benchmark.parts": ("demheat.scene", "demheat.files"),
    "benchmark.schema": (),
    "benchmark": ("demheat.scene", "benchmark.parts"),
    "benchmark.recipes": (
        "demheat.scene",
        "demheat.addition",
        "demheat.gallery",
        "demheat.referee",
        "references",
        "benchmark",
        "benchmark.recipes",
    ),
    "benchmark.make": ("benchmark",),
    "studies.harness": ("demheat", "references", "studies.harness"),
    "studies.common": ("demheat", "references", "studies.harness", "studies.common"),
    # And every study itself, if it is a folder.
    "studies": ("demheat", "references", "benchmark", "studies.harness", "studies.common"),
    "studies.__main__": ("demheat.fresh", "studies"),
}
# Packages whose own room is for their front alone.
FRONTS = ("demheat", "references", "benchmark")


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
