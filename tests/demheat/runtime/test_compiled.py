"""Only here: old, broken or foreign machine code that is run, and kernels that cannot be kept and stop a solve."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from demheat import on_progress
from demheat.runtime import compiled, progress

ROOT = Path(__file__).parents[3]


def package(folder, **files):
    """A folder with a package `demheat` of these files."""
    for name, text in files.items():
        path = folder / "demheat" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return folder


def key(folder, name):
    compiled.source_key.cache_clear()
    return compiled.source_key(folder / "demheat" / f"{name}.py", folder)


def test_the_key_is_that_of_the_text_wherever_it_lies(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    one = package(tmp_path / "a", own_kernels="x = 1\n")
    two = package(tmp_path / "b", own_kernels="x = 1\n")
    assert key(one, "own_kernels") == key(two, "own_kernels")
    (two / "demheat" / "own_kernels.py").write_text("x = 2\n")
    assert key(one, "own_kernels") != key(two, "own_kernels")


@pytest.mark.parametrize(
    "words",
    ["from demheat.other_kernels import f", "from demheat import other_kernels", "from .other_kernels import f",
     "import demheat.other_kernels as o", "def g():\n    from demheat.between_kernels import f"],
)  # fmt: skip
def test_what_a_kernel_imports_counts(tmp_path, words):
    """Numba's own stamp does not see this: the old machine code would run."""
    folder = package(
        tmp_path, own_kernels=words, other_kernels="f = 1\n", between_kernels="from demheat.other_kernels import f\n"
    )
    before = key(folder, "own_kernels")
    (folder / "demheat" / "other_kernels.py").write_text("f = 2\n")
    assert key(folder, "own_kernels") != before
    unlike = key(folder, "other_kernels")
    (folder / "demheat" / "own_kernels.py").write_text(words + "\ny = 3\n")
    assert key(folder, "other_kernels") == unlike


def test_versions_count(tmp_path, monkeypatch):
    folder = package(tmp_path, own_kernels="x = 1\n")
    before = key(folder, "own_kernels")
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "VERSIONS", ("another",))
        assert key(folder, "own_kernels") != before
    # Checks of bounds are compiled in.
    monkeypatch.setattr(compiled.numba.config, "BOUNDSCHECK", 1)
    assert key(folder, "own_kernels") != before


def run(code, **environment):
    env = {name: value for name, value in os.environ.items() if name not in ("NUMBA_CACHE_DIR", "NUMBA_DISABLE_JIT")}
    env |= {"PYTHONPATH": str(ROOT), **environment}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
    return done.stdout.split(), done.stderr


PLACE = "from demheat.packing import cells_kernels as k; print(k.fill_cells._cache.cache_path)"


def test_kernels_are_kept_in_the_users_folder_or_the_one_asked_for(tmp_path, monkeypatch):
    (place,), said = run(PLACE, XDG_CACHE_HOME=str(tmp_path))
    assert Path(place).parent == tmp_path / "demheat" / "kernels" and Path(place).name.startswith("cells_kernels-")
    assert said == ""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "asked"))
    compiled.base_folder.cache_clear()
    try:
        assert compiled.base_folder() == tmp_path / "asked"
    finally:
        compiled.base_folder.cache_clear()


def test_without_any_folder_kernels_are_compiled_for_this_run_and_a_line_says_so(tmp_path, monkeypatch):
    # Below a file nobody can write, not even root.
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    # Set before it is taken away, so that what the run sets is taken back: else all after this test would compile anew.
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "file" / "compiled.py"))
    compiled.base_folder.cache_clear()
    try:
        with pytest.warns(UserWarning, match="set NUMBA_CACHE_DIR"):
            folder = compiled.base_folder()
        assert folder.is_dir() and os.environ["NUMBA_CACHE_DIR"] == str(folder)
    finally:
        compiled.base_folder.cache_clear()


def test_without_any_home_kernels_are_kept_beside_the_package(tmp_path, monkeypatch):
    """A user whom the system does not know, and who has no HOME: asking for the folder raises RuntimeError."""

    def nobody(path):
        raise RuntimeError("Could not determine home directory.")

    for name in ("XDG_CACHE_HOME", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(compiled.Path, "expanduser", nobody)
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    compiled.base_folder.cache_clear()
    try:
        assert compiled.base_folder() == tmp_path / "__pycache__" / "kernels"
    finally:
        compiled.base_folder.cache_clear()


def test_an_unwritable_home_is_passed_over_in_silence_for_the_package(tmp_path):
    (tmp_path / "file").touch()
    below = str(tmp_path / "file" / "home")
    (place,), said = run(PLACE, HOME=below, XDG_CACHE_HOME=below)
    assert Path(place).parent == ROOT / "demheat" / "runtime" / "__pycache__" / "kernels" and said == ""


def test_old_machine_code_is_thrown_away(tmp_path):
    for name, age in (("new_kernels-1", 0.0), ("old_kernels-1", 2 * compiled.KEPT), ("other", 2 * compiled.KEPT)):
        (tmp_path / name).mkdir()
        then = (tmp_path / name).stat().st_mtime - age
        os.utime(tmp_path / name, (then, then))
    compiled._tidy(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new_kernels-1", "other"]


def test_machine_code_that_is_asked_for_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled, "base_folder", lambda: tmp_path)
    old = tmp_path / "old_kernels-1"
    old.mkdir()
    then = old.stat().st_mtime - 2 * compiled.KEPT
    os.utime(old, (then, then))
    try:
        assert compiled._folder_of("old_kernels", "1") == str(old)
    finally:
        compiled._folder_of.cache_clear()
    compiled._tidy(tmp_path)
    assert old.is_dir()


def test_only_kernels_of_ours_are_placed(tmp_path):
    assert compiled.ByContent.from_function(lambda: None, str(tmp_path / "x.py")) is None
    assert compiled.ByContent.from_function(lambda: None, os.__file__) is None


def test_compiling_is_said_once_it_has_taken_long(monkeypatch):
    monkeypatch.setattr(progress, "PAUSE", 0.01)
    monkeypatch.setattr(progress, "WAIT", 0.0)
    monkeypatch.setattr(progress, "SILENT", 0.05)
    heard, listener = [], compiled.Compiling()
    on_progress(heard.append)
    try:
        with warnings.catch_warnings():
            # Each is shorter than the silence; together they are longer.
            for _ in range(4):
                listener.on_start(None)
                listener.on_start(None)
                progress.time.sleep(0.03)
                listener.on_end(None)
                listener.on_end(None)
    finally:
        on_progress(None)
    assert listener.depth == 0 and not progress._open
    assert heard and {report.stage for report in heard} == {"compiling, once"}
    assert all(report.elapsed >= 0.05 for report in heard)


def test_numba_tells_us(monkeypatch):
    """The event of its interface, of a kernel that is compiled now."""
    numba = pytest.importorskip("numba")
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled")
    told = []
    monkeypatch.setattr(compiled.Compiling, "on_start", lambda self, event: told.append("start"))
    monkeypatch.setattr(compiled.Compiling, "on_end", lambda self, event: told.append("end"))
    numba.njit(lambda x: x + 1)(1)
    assert told == ["start", "end"]


def test_without_even_a_temporary_folder_a_line_says_what_to_set(monkeypatch):
    def nowhere(prefix):
        raise FileNotFoundError("No usable temporary directory found")

    monkeypatch.setattr(compiled.tempfile, "mkdtemp", nowhere)
    with pytest.raises(RuntimeError, match="No usable temporary directory.*: set NUMBA_CACHE_DIR"):
        compiled._of_this_run()


def test_numbers_of_the_source_are_integers_like_others():
    numba = pytest.importorskip("numba")
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled")

    @numba.njit
    def more(x):
        return x + 1

    @numba.njit
    def sums(n):
        return more(0) + more(1) + more(n)

    # Others' kernels are left to Numba.
    more.py_func.__module__ = "demheat.made_up"
    assert sums(2) == 6 and len(more.within.signatures) == 1
    # Python cannot call what was compiled for kernels alone: for it there is another, which further kernels take.
    assert not more.signatures and more(2) == 3 and len(more.signatures) == 1

    @numba.njit
    def again(n):
        return more(n) + more(1.5)

    assert again(2) == 5.5 and len(more.within.signatures) == 2


def damages(folder):
    """Ways to break the files of a kernel, one after the other."""
    (index,), (code,) = folder.rglob("*.nbi"), folder.rglob("*.nbc")
    whole, machine = index.read_bytes(), code.read_bytes()
    yield "index cut", lambda: index.write_bytes(whole[:20])
    yield "index empty", lambda: index.write_bytes(b"")
    yield "index of something else", lambda: index.write_bytes(b"no pickle" * 9)
    yield "code cut", lambda: code.write_bytes(machine[: len(machine) // 2])
    # In the middle there is machine code, which would be run.
    middle = len(machine) // 2
    flipped = machine[:middle] + bytes([machine[middle] ^ 1]) + machine[middle + 1 :]
    yield "a bit of the code", lambda: code.write_bytes(flipped)


@pytest.fixture
def called(tmp_path, monkeypatch):
    """Call a small kernel as a new process would: what it gives, how often machine code was found, what was said."""
    numba = pytest.importorskip("numba")
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled")
    from demheat.packing import cells_kernels

    def call(*arguments):
        fresh = numba.njit(cache=True)(cells_kernels._wrapped.py_func)
        compiled._said.clear()
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            value = fresh(*arguments)
        return value, sum(fresh.stats.cache_hits.values()), [str(each.message) for each in said]

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    for kept in (compiled.base_folder, compiled._folder_of):
        kept.cache_clear()
    yield call
    for kept in (compiled.base_folder, compiled._folder_of):
        kept.cache_clear()


def test_broken_machine_code_is_made_again(called, tmp_path):
    assert called(7, 5) == (2, 0, []) and called(7, 5) == (2, 1, [])
    for how, damage in damages(tmp_path):
        damage()
        value, hits, said = called(7, 5)
        assert (value, hits, len(said)) == (2, 0, 1) and "are compiled again, some cannot be read" in said[0], how
        assert called(7, 5) == (2, 1, []), how


def test_machine_code_of_other_types_is_not_run(called, tmp_path):
    """Two processes that write at one time may leave one's code under the other's types."""
    assert called(7, 5) == (2, 0, []) and called(7.5, 5.0) == (2.5, 0, [])
    one, other = sorted(tmp_path.rglob("*.nbc"))
    other.write_bytes(one.read_bytes())
    value, hits, said = called(7.5, 5.0)
    assert (value, hits) == (2.5, 0) and said[0].endswith("(it is of other types)")


def test_a_full_disk_costs_no_kernel(called, monkeypatch):
    """What is compiled is used, and one line says what to do."""
    from numba.core.caching import IndexDataCacheFile

    def full(self, path):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(IndexDataCacheFile, "_open_for_write", full)
    value, hits, said = called(7, 5)
    assert (value, hits, len(said)) == (2, 0, 1)
    assert "cannot be kept: set NUMBA_CACHE_DIR" in said[0] and "No space left" in said[0]
