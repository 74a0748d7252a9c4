"""Where compiled kernels are kept between runs, and what is said while they are compiled.

Numba keeps machine code beside the source or by the path of the source, and does not see when a kernel changes that
another file imports. Here the key is the content: the kernels' file, all files of ours that it imports, and the
versions of Python and of the libraries that compile. So copies of one source share their machine code, and no change is
missed. Numba adds the processor's name and features itself.

Imported by every package that has kernels, before any of them is decorated. Without Numba's own lists of places, which
are not part of its documented interface, kernels are kept where Numba puts them.
"""

import ast
import atexit
import contextlib
import functools
import gc
import hashlib
import os
import re
import shutil
import sys
import tempfile
import time
import warnings
from pathlib import Path

import llvmlite
import numba
import numpy as np
from numba.core import event, types

from demheat.runtime.progress import in_parts

# Sources are ours below this folder, in these packages.
ROOT, OURS = Path(__file__).resolve().parents[2], ("demheat", "references", "studies")
VERSIONS = (sys.version, numba.__version__, llvmlite.__version__, np.__version__)
# Layout of the files, see `_keep_with_care`.
FORMAT = 2
# Settings of Numba that change the code it makes.
SETTINGS = ("OPT", "BOUNDSCHECK", "LOOP_VECTORIZE", "SLP_VECTORIZE", "DEBUGINFO_DEFAULT")
# Machine code that nobody asked for so long is thrown away.
KEPT = 60 * 24 * 3600.0
# Python looks for unreachable cycles whenever 700 objects are new; compiling makes a million that live on. Rarer looks
# spare a fifteenth of the CPU-seconds.
RARE = (50_000, 20, 20)


def kernel_folder() -> Path:
    """Folder of the machine code: NUMBA_CACHE_DIR, else demheat/kernels in XDG_CACHE_HOME, else in ~/.cache."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return Path(os.environ["NUMBA_CACHE_DIR"]).expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "demheat" / "kernels"


@functools.cache
def source_key(path: Path, root: Path = ROOT) -> str:
    """Digest of a source file, of all of ours that it imports, and of the versions of what compiles it."""
    settings = [str(getattr(numba.config, name, None)) for name in SETTINGS]
    digest = hashlib.sha256(repr((FORMAT, VERSIONS, settings)).encode())
    for each in sorted(_sources(path, root, set())):
        digest.update(each.relative_to(root).as_posix().encode() + each.read_bytes())
    return digest.hexdigest()


def _sources(path, root, found):
    """The file and all files of ours that it imports, directly or not, but for this one."""
    if path in found or path == Path(__file__).resolve() or not path.is_file():
        return found
    found.add(path)
    text = path.read_text(encoding="utf-8")
    if re.search(rf"^\s*(from|import)\s+({'|'.join(OURS)}|\.)\b", text, re.MULTILINE):
        for name in _imported(ast.parse(text), path, root):
            if name.split(".")[0] in OURS:
                _sources(root.joinpath(*name.split(".")).with_suffix(".py"), root, found)
    return found


def _imported(tree, path, root):
    """Dotted names that a source imports, modules or things in them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = path.relative_to(root).parts[: -node.level] if node.level else ()
            base = ".".join((*above, *filter(None, [node.module])))
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


class ByContent:
    """Numba's view of where the machine code of one of our kernels is kept (its "cache locator")."""

    def __init__(self, function, path):
        self.key, self.line = source_key(path), function.__code__.co_firstlineno
        self._py_file = str(path)  # Numba names it in warnings

    @classmethod
    def from_function(cls, function, file):
        """The place of a function of ours; None for any other, which Numba then finds a place for."""
        path = Path(file).resolve()
        if not path.is_relative_to(ROOT) or path.relative_to(ROOT).parts[0] not in OURS or not path.is_file():
            return None
        return cls(function, path)

    def ensure_cache_path(self):
        """Make the folder, if somebody threw it away."""
        Path(self.get_cache_path()).mkdir(parents=True, exist_ok=True)

    def get_cache_path(self):
        """Folder of the machine code."""
        return _folder_of(Path(self._py_file).stem, self.key)

    def get_source_stamp(self):
        """What machine code is stamped with, and is not used without."""
        return self.key

    def get_disambiguator(self):
        """What sets functions of one name in one file apart."""
        return str(self.line)


def is_kept(path: Path) -> bool:
    """Whether there is machine code of any of the kernels of a file, as it is now."""
    return any(Path(_folder_of(path.stem, source_key(path.resolve()))).glob("*.nbi"))


@functools.cache
def base_folder() -> Path:
    """The first of these that can be written: the user's folder, one beside this file, one of this run alone."""
    beside = Path(__file__).parent / "__pycache__" / "kernels"
    for place in (kernel_folder, lambda: beside):
        try:
            folder = place()
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except (OSError, RuntimeError):  # the latter where nobody knows of a home
            continue
        _tidy(folder)
        return folder
    warnings.warn(
        "no folder for compiled kernels can be written: each run compiles them; set NUMBA_CACHE_DIR", stacklevel=2
    )
    return _of_this_run()


def _of_this_run():
    """A folder that processes started by this one find, and that ends with it."""
    try:
        folder, owner = tempfile.mkdtemp(prefix="demheat-kernels-"), os.getpid()
    except OSError as error:
        raise RuntimeError(
            f"no folder at all can be written for compiled kernels ({error}): set NUMBA_CACHE_DIR"
        ) from None
    os.environ["NUMBA_CACHE_DIR"] = folder
    atexit.register(lambda: os.getpid() == owner and shutil.rmtree(folder, ignore_errors=True))
    return Path(folder)


@functools.cache
def _folder_of(name, key):
    """The folder of one key, made now if need be, and marked as in use."""
    folder = base_folder() / f"{name}-{key[:24]}"
    folder.mkdir(exist_ok=True)
    with contextlib.suppress(OSError):  # another's, which can be read
        os.utime(folder)
    return str(folder)


def _tidy(folder):
    """Throw machine code away that nobody asked for so long: it is of sources or versions that have changed."""
    now = time.time()
    for each in folder.glob("*kernels-*"):
        with contextlib.suppress(OSError):  # another process was faster
            if now - each.stat().st_mtime > KEPT:
                shutil.rmtree(each, ignore_errors=True)


class Compiling(event.Listener):
    """Says that kernels are being compiled once it has taken long, counted over all of them."""

    def __init__(self):
        self.depth, self.parts, self.said, self.usual = 0, in_parts("compiling, once"), None, gc.get_threshold()

    def on_start(self, event):
        """A kernel begins: the outermost counts, not those that it calls."""
        self.depth += 1
        if self.depth == 1:
            self.usual = gc.get_threshold()
            gc.set_threshold(*RARE)
            self.said = self.parts()
            self.said.__enter__()

    def on_end(self, event):
        """It ends."""
        self.depth -= 1
        if self.depth == 0:
            gc.set_threshold(*self.usual)
            self.said.__exit__(None, None, None)


def _keep_by_content():
    """Put our places before Numba's own, for functions of ours."""
    try:
        from numba.core.caching import CacheImpl
    except ImportError:
        return
    places = getattr(CacheImpl, "_locator_classes", None)
    if isinstance(places, list) and ByContent not in places:
        places.insert(0, ByContent)


_said = set()


def _say_once(words, folder, error):
    """One line for all kernels of a folder: a full disk fails for a hundred of them."""
    if (words, folder) not in _said:
        _said.add((words, folder))
        warnings.warn(f"compiled kernels in {folder} {words} ({error})", stacklevel=4)


def _keep_with_care():
    """Have kernels of ours compiled again where their machine code is not what was written, and used if it cannot be.

    Numba fails on a file that is cut or a disk that is full, and loads whatever a file holds: that of other types, if
    two processes wrote at one time.
    """
    try:
        from numba.core.caching import Cache, IndexDataCacheFile
    except ImportError:
        return
    if getattr(Cache.load_overload, "careful", False):
        return

    class Checked(IndexDataCacheFile):
        """Machine code with what it is of and a checksum at its end, which others who read the file pass over."""

        def save(self, key, data):
            super().save(key, (key, data))

        def load(self, key):
            found = super().load(key)
            if found is not None and found[0] != key:
                raise ValueError("it is of other types")
            return found and found[1]

        def _dump(self, obj):
            raw = super()._dump(obj)
            return raw + hashlib.sha256(raw).digest()

        def _load_data(self, name):
            raw = Path(self._data_path(name)).read_bytes()
            if hashlib.sha256(raw[:-32]).digest() != raw[-32:]:
                raise ValueError("the checksum does not fit")
            return super()._load_data(name)

    def careful(usual, words):
        @functools.wraps(usual)
        def wrapped(self, *arguments):
            if not isinstance(self._impl.locator, ByContent):
                return usual(self, *arguments)
            self._cache_file.__class__ = Checked
            try:
                return usual(self, *arguments)
            except Exception as error:  # noqa: BLE001, whatever pickle makes of a broken file
                _say_once(words, Path(self.cache_path).parent, error)
            with contextlib.suppress(OSError):
                self.flush()
            return None

        wrapped.careful = True
        return wrapped

    Cache.load_overload = careful(Cache.load_overload, "are compiled again, some cannot be read")
    Cache.save_overload = careful(Cache.save_overload, "cannot be kept: set NUMBA_CACHE_DIR to another folder")


def _compile_for_types():
    """Let kernels that call kernels of ours with numbers of the source, as 0, compile them for integers once.

    Numba would compile them for each of these numbers again, and for what a variable begins with: a tenth of the time.
    """
    try:
        from numba.core.dispatcher import Dispatcher
        from numba.core.sigutils import normalize_signature
    except ImportError:
        return
    usual = getattr(Dispatcher, "get_call_template", None)
    if usual is None or getattr(usual, "ours", False):
        return

    found = Dispatcher.get_overload

    @functools.wraps(usual)
    def for_types(self, args, kws):
        if self.py_func.__module__.split(".")[0] in OURS:
            args = tuple(types.unliteral(each) for each in args)
            kws = {name: types.unliteral(each) for name, each in kws.items()}
            if not kws and args not in self.overloads:
                self = _within(self)
        return usual(self, args, kws)

    @functools.wraps(found)
    def overload_of(self, sig):
        args, _ = normalize_signature(sig)
        inner = self.__dict__.get("within")
        return found(inner if inner and tuple(args) not in self.overloads else self, sig)

    for_types.ours = True
    Dispatcher.get_call_template, Dispatcher.get_overload = for_types, overload_of


def _within(dispatcher):
    """A function as kernels call it: without what Python needs to call it, which takes a fifth of the time.

    It is kept within the kernels, not by itself.
    """
    if "within" not in dispatcher.__dict__:
        options = dispatcher.targetoptions | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        dispatcher.within = type(dispatcher)(dispatcher.py_func, dispatcher.locals, options)
    return dispatcher.within


_keep_by_content()
_keep_with_care()
_compile_for_types()
event.register("numba:compile", Compiling())
