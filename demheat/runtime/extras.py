"""Libraries that one method or one kind of file needs: where one is missing, a sentence says which extra brings it."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

# Extras of pyproject.toml, each with the libraries that it brings, as they are imported; of methods by their names.
EXTRAS = {
    "fem": ("skfem", "gmsh", "meshio"),
    "fft": ("pyfftw",),
    "plot": ("matplotlib",),
    "pandas": ("pandas",),
    "xarray": ("xarray",),
    "pyvista": ("pyvista",),
}
EXTRA_OF = {library: name for name, libraries in EXTRAS.items() for library in libraries}


@contextmanager
def extra(what: str) -> Iterator[None]:
    """Say of a library that is imported within, and is not installed, who needs it and which extra brings it."""
    try:
        yield
    except ModuleNotFoundError as error:
        library = (error.name or "").partition(".")[0]
        if library not in EXTRA_OF:
            raise
        raise ImportError(missing(library, what), name=library) from error


def lacking(method: str) -> str:
    """Why a method cannot be had, from what is installed; empty if nothing of its extra is missing."""
    absent = next((library for library in EXTRAS.get(method, ()) if find_spec(library) is None), "")
    return absent and missing(absent, method)


def missing(library: str, what: str) -> str:
    """The sentence that says so."""
    return f"{what} needs {library}, which is not installed: pip install 'demheat[{EXTRA_OF[library]}]'"
