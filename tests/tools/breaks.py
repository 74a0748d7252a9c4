"""Break the code in small ways that were chosen, one at a time, and look which test sees it.

    python tests/tools/breaks.py tests/tools/chosen.csv --out seen.csv [--near] [--part 1/4]

tries the breaks of a list (columns module, before, after, meaning; `before` stands once in the module), each in a
throw-away copy of the tree, where tests run, nearest first, until one fails: those named after the module, those that
import it, the rest of their folder, those of all methods, then all of `make test`; with --near only those of the
module's folder. A test that runs over its limit has seen it too; one that fails in the sound copy as well says nothing
and is left out. Breaks already in the table are passed over.

In the table `caught` is yes or no.
"""

import argparse
import csv
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
# Parts of the tree that tests need.
NEEDED = ("demheat", "references", "studies", "tests", "results", "docs", "benchmark", "examples", "*.md", "*.toml")
NEEDED += ("Makefile", "CITATION.cff", "LICENSE")
# What sees methods as wholes, for breaks that the tests of their folder let pass.
WIDE = ("tests/test_methods.py", "tests/demheat/dem/test_dem.py", "tests/demheat/test_laws.py", "tests/test_pores.py")
WIDE += ("tests/test_order.py", "tests/test_bad_inputs.py")
COLUMNS = ("module", "line", "kind", "before", "after", "caught", "by", "note")
# CPU-seconds of one test, compiling included, many times what the slowest needs; and seconds of a whole call, for what
# waits for ever.
TEST, CALL = 60, 1500


class Mutant(NamedTuple):
    """One break: where in the text, what stands there and what instead."""

    line: int
    start: int
    end: int
    kind: str
    before: str
    after: str

    def apply(self, text):
        """The broken source."""
        return text[: self.start] + self.after + text[self.end :]

    def words(self):
        """Both sides in one line."""
        return " ".join(self.before.split()), " ".join(self.after.split())


class Break(NamedTuple):
    """A break of a module."""

    module: Path
    mutant: Mutant

    def key(self):
        """What finds it in the table."""
        return (self.module.as_posix(), str(self.mutant.line), self.mutant.kind, *self.mutant.words())


def listed(path, root=ROOT):
    """Breaks of a list, and its rows whose text no longer stands once in their module."""
    found, gone = [], []
    for row in rows(path):
        source, before = root / row["module"], row["before"]
        text = source.read_text(encoding="utf-8") if source.is_file() else ""
        if text.count(before) != 1:
            gone.append(row)
            continue
        start = text.index(before)
        line, end = text.count("\n", 0, start) + 1, start + len(before)
        found.append(Break(Path(row["module"]), Mutant(line, start, end, row["meaning"], before, row["after"])))
    return found, gone


def stages(module, root=ROOT, rest=False):
    """Lists of test files to run one after another for a break of a module, none twice, none empty."""
    package = module.parent if module.stem == "__init__" else module.with_suffix("")
    near, exact = _mirror(package, root)
    beside = sorted(near.rglob("test_*.py") if exact else near.glob("test_*.py"))
    everywhere = sorted((root / "tests").rglob("test_*.py"))
    named = [path for path in beside if re.search(rf"_{package.name.removesuffix('_kernels')}(_|\.)", path.name)]
    named = named or [path for path in beside if path.name == f"test_{module.parent.name}.py"]
    importing = [path for path in everywhere if _imports(path, package)]
    wide = [root / name for name in WIDE if (root / name).is_file()]
    if module.parts[0] == "studies":
        wide = sorted((root / "tests" / "studies").glob("test_*.py"))
    folders = {path.relative_to(root).parts[:2]: None for path in everywhere} if rest else {}
    others = [[path for path in everywhere if path.relative_to(root).parts[:2] == folder] for folder in folders]
    done, found = set(), []
    for group in (named, importing, beside, wide, *others):
        fresh = [path.relative_to(root).as_posix() for path in dict.fromkeys(group) if path not in done]
        done.update(group)
        found += [fresh] if fresh else []
    return found


def _mirror(package, root):
    """The folder of tests that mirrors a package's or, if there is none, the nearest above it; and whether it does."""
    folder = root / "tests" / package
    while not folder.is_dir():
        folder = folder.parent
    return folder, folder == root / "tests" / package


def _imports(path, package):
    """Whether a file imports a module, or anything of it, in a line of its own."""
    above, word = ".".join(package.parts[:-1]), package.name
    line = rf"^from {re.escape(above)} import .*\b{word}\b|^(from|import) {re.escape(above)}\.{word}\b"
    return re.search(line, path.read_text(encoding="utf-8"), re.MULTILINE)


def pytest_runtest_setup(item):
    """Give the test its CPU-seconds: the clock kills the process, even within compiled code."""
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, float(os.environ["BREAKS_TEST"]))


class Copies:
    """A sound copy of the tree, and broken copies of that; machine code is kept by content and shared by all."""

    def __init__(self, folder, root=ROOT, limit=TEST):
        self.folder, self.sound, self.limit = folder, folder / "sound", limit
        self.kernels = Path(os.environ.get("NUMBA_CACHE_DIR") or folder / "kernels")
        for path in (path for pattern in NEEDED for path in root.glob(pattern)):
            copy = shutil.copytree if path.is_dir() else shutil.copy2
            (self.sound / path.relative_to(root).parent).mkdir(parents=True, exist_ok=True)
            copy(path, self.sound / path.relative_to(root))
        self.kernels.mkdir(exist_ok=True)
        self.trusted, self.lock = {}, Lock()

    def of(self, broken):
        """A copy with the break in it. It has the sound copy's bytecode of all other modules."""
        copy = Path(tempfile.mkdtemp(dir=self.folder)) / "tree"
        shutil.copytree(self.sound, copy)
        path = copy / broken.module
        path.write_text(broken.mutant.apply(path.read_text(encoding="utf-8")), encoding="utf-8")
        return copy

    def ran(self, tree, tests, *options, plain=False):
        """Run tests in a copy. Returns the first that fails or hangs, or None."""
        own = {
            "PYTHONPATH": os.pathsep.join(map(str, (tree, tree / "tests", ROOT / "tests"))),
            "PYTHONUNBUFFERED": "1",  # what hangs has said its name
            "NUMBA_CACHE_DIR": str(self.kernels),
            "NUMBA_DISABLE_JIT": str(int(plain)),
            "BREAKS_TEST": str(self.limit),
        }
        words = [sys.executable, "-m", "pytest", "-v", "-x", "-p", "no:cacheprovider", "-p", "tools.breaks", *options]
        words += [f"--deselect={name}" for name, sound in list(self.trusted.items()) if not sound]
        log = tree.parent / "log"
        with log.open("w") as out:
            process = subprocess.Popen(
                [*words, *tests], cwd=tree, env=os.environ | own, stdout=out, stderr=out, start_new_session=True
            )
            try:
                status = process.wait(CALL)
            except subprocess.TimeoutExpired:
                status = -signal.SIGALRM
            finally:
                _end(process)
        return _seen(log.read_text(errors="replace"), status)

    def is_trusted(self, test):
        """Whether a test passes in the sound copy."""
        with self.lock:
            if test not in self.trusted:
                self.trusted[test] = self.ran(self.sound, [test]) is None
        return self.trusted[test]

    def first_seen(self, broken, wide=True, rest=False):
        """The first test that sees a break, or None."""
        copy, nearest = self.of(broken), True
        try:
            for tests, plain in self._calls(broken.module, wide, rest):
                if by := self._sees(copy, tests, plain, nearest):
                    return by
                nearest = False
        finally:
            shutil.rmtree(copy.parent)
        return None

    def _sees(self, copy, tests, plain, nearest):
        """The first of some tests that sees the break of a copy, or None."""
        by_chance = []
        while by := self.ran(copy, tests, "-m", "twin" if plain else "not slow", *by_chance, plain=plain):
            name = by.split(" (")[0]
            if name.startswith("tests/") and not self.is_trusted(name):
                if "::" not in name:  # cannot even be read
                    return None
            # Far from the module a test may fail by chance: once more.
            elif nearest or "::" not in by or self.ran(copy, [name], plain=plain):
                return by
            else:
                by_chance.append(f"--deselect={name}")
        return None

    def _calls(self, module, wide, rest):
        """Test files to run together, and whether without compiling: kernels are tried so first, which is fast."""
        found = stages(module, self.sound, rest)
        if module.stem.endswith("kernels"):
            yield found[0], True
        yield from ((tests, False) for tests in (found if wide else found[:-1] or found))


def _end(process):
    """Nothing that a test started outlives it."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    process.wait()


def _seen(log, status):
    """The test that failed or hung, from what pytest printed."""
    if status in (0, 5):  # 5: nothing to run
        return None
    failed = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", log, re.MULTILINE)
    if failed:
        return failed[1]
    last = re.findall(r"^(tests/\S+)", log, re.MULTILINE)
    how = "hang" if -status in (signal.SIGPROF, signal.SIGALRM) else f"ended with {status}"
    return f"{last[-1] if last else 'import'} ({how})"


def tried(broken, copies, wide=True, rest=False):
    """One row of the table."""
    by = copies.first_seen(broken, wide, rest)
    return [*broken.key(), "yes" if by else "no", by or "", ""]


def rows(path):
    """Rows of a table, if there is one."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def run(breaks, out, *, jobs=1, wide=True, rest=False, root=ROOT, limit=TEST):
    """Try breaks that are not in the table yet, and add them."""
    done = {tuple(row[name] for name in COLUMNS[:5]) for row in rows(out)}
    todo, lock = [each for each in breaks if each.key() not in done], Lock()
    if not out.is_file():
        out.write_text(",".join(COLUMNS) + "\n", encoding="utf-8")

    def try_one(broken):
        row = tried(broken, copies, wide, rest)
        with lock, out.open("a", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerow(row)
            print(f"{row[0]}:{row[1]}: {row[3]}  ->  {row[4]}: {row[6] or 'UNSEEN'}", flush=True)

    with tempfile.TemporaryDirectory(prefix="breaks-", ignore_cleanup_errors=True) as folder:
        copies = Copies(Path(folder), root, limit)
        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(try_one, todo))


def main():
    """The command line."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("list", type=Path, metavar="FILE", help="breaks that were chosen")
    words.add_argument("--part", default="1/1", metavar="K/N", help="every Nth of them, from the Kth on")
    words.add_argument("--out", type=Path, default=Path("breaks.csv"))
    words.add_argument("--jobs", type=int, default=1)
    words.add_argument("--near", action="store_true", help="only tests of the module's folder")
    given = words.parse_args()
    breaks, gone = listed(given.list)
    for row in gone:
        print(f"{row['module']}: {row['before']!r} does not stand there once: passed over")
    part, parts = map(int, given.part.split("/"))
    near = given.near
    run(breaks[part - 1 :: parts], given.out, jobs=given.jobs, wide=not near, rest=not near)
    seen = [row["caught"] for row in rows(given.out)]
    print(f"{seen.count('yes')} of {len(seen)} seen")


if __name__ == "__main__":
    main()
