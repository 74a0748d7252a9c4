"""Try every fault on real runs and write docs/faults.md: what was done, how often, what was wrong.

    PYTHONPATH=.:tests python tests/tools/try_faults.py [--kills N] [--seed N]

takes some CPU-minutes. Disks that are full or read-only are small ones of their own, where the system lets a user mount
them (Linux, `unshare`); locales are made by `localedef`, where it is there.
"""

import argparse
import os
import random
import shutil
import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path

import faults
from faults import ROOT, Toy

PAGE = ROOT / "docs" / "faults.md"
SOLVE = """
import numpy, demheat, sys
from demheat import gallery
field = demheat.solve(gallery.sphere_in_cube(periodic=True), particles=300, seed=1)
sys.stdout.write(f"{field.conductivity!r}")
"""


def kills(home, right, count, seed):
    """A run is killed at a random moment and begun again, over and over; once at its end, in a new folder."""
    rng, (rows, seconds), wrong, ended = random.Random(seed), right, [], 0
    toy, before = None, {}
    for number in range(count):
        if toy is None:
            folder = home / f"kill{number}"
            folder.mkdir()
            toy, before = Toy(folder), {}
        found, status = faults.killed(toy, rng.uniform(0.0, seconds), group=rng.random() < 0.5)
        wrong += found + faults.compared(toy, rows, before)
        before = toy.rows()
        if status == 0 or len(before) == len(rows):
            ended += status == 0
            if toy.run()[0] != 0 or toy.rows() != rows:
                wrong.append("not as if nobody had killed it")
            toy = None
        print(f"kill {number + 1}: {len(before)} rows, {wrong}", flush=True)
    return (
        f"run killed at random moments, process or process group, seed {seed}",
        count,
        wrong,
        f"{ended} had ended before",
    )


def at_one_time(home, right, times=3):
    """Two runs on one folder."""
    wrong = []
    for number in range(times):
        folder = home / f"two{number}"
        folder.mkdir()
        toy = Toy(folder)
        runs = [toy.start(), toy.start()]
        said = [run.communicate()[1] for run in runs]
        wrong += [repr(each) for run, each in zip(runs, said, strict=True) if run.returncode or each]
        wrong += faults.compared(toy, right[0], right[0])
    return "two runs on one folder at one time", times, wrong, "both end with status 0"


ODD = {
    "LC_ALL=C without UTF-8": ([], {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}),
    "LC_ALL=POSIX": ([], {"LC_ALL": "POSIX"}),
    "LC_ALL=de_DE.ISO-8859-1": ([], {"LC_ALL": "de_DE.ISO-8859-1"}),
    "LC_ALL=de_DE.UTF-8": ([], {"LC_ALL": "de_DE.UTF-8"}),
    "LC_ALL=tr_TR.UTF-8": ([], {"LC_ALL": "tr_TR.UTF-8"}),
    "python -O": (["-O"], {}),
    "python -OO": (["-OO"], {}),
    "python -W error": (["-W", "error"], {}),
    "PYTHONHASHSEED=1": ([], {"PYTHONHASHSEED": "1"}),
    "PYTHONHASHSEED=2": ([], {"PYTHONHASHSEED": "2"}),
    "HOME unset": ([], {"HOME": None}),
    # Matplotlib has words of its own for such a home.
    "HOME a file": ([], {"HOME": "/proc/version", "MPLCONFIGDIR": tempfile.gettempdir()}),
}


def odd(home, right):
    """Odd ways to start: the study, and one solve by the DEM, whose number must be that of a usual start."""
    locales = _locales(home)
    usual, _ = _solved([], {})
    for number, (name, (python, changes)) in enumerate(ODD.items()):
        folder = home / f"odd{number}"
        folder.mkdir()
        toy = Toy(folder)
        there = changes | ({"LOCPATH": str(locales)} if "_" in changes.get("LC_ALL", "") else {})
        status, _, error = toy.run(python=python, **there)
        wrong = [f"status {status}, said {error!r}"] if status or error else []
        wrong += faults.compared(toy, right[0], right[0])
        found, said = _solved(python, there)
        wrong += [f"solve gives {found}, not {usual}"] if found != usual else []
        yield name, 2, wrong, _short(" ".join(said), home)


def _locales(home):
    folder = home / "locales"
    folder.mkdir()
    for name, alphabet in (("de_DE", "UTF-8"), ("de_DE", "ISO-8859-1"), ("tr_TR", "UTF-8")):
        if shutil.which("localedef"):
            words = ["localedef", "-i", name, "-f", alphabet, str(folder / f"{name}.{alphabet}")]
            subprocess.run(words, capture_output=True)
    return folder


def _solved(python, changes, code=SOLVE):
    """What a solve prints: its conductivity and what it says besides."""
    env = os.environ | {"PYTHONPATH": str(ROOT), "DEMHEAT_WARM": "0"}
    env |= {name: value for name, value in changes.items() if value is not None}
    env = {name: value for name, value in env.items() if changes.get(name, "") is not None}
    # A program that lets the locale write its numbers: a decimal comma, a dotless i.
    code = "import locale\ntry:\n    locale.setlocale(locale.LC_ALL, '')\nexcept locale.Error:\n    pass\n" + code
    done = subprocess.run([sys.executable, *python, "-c", code], env=env, capture_output=True, text=True)
    lines = done.stderr.strip().splitlines()
    return done.stdout, [line for line in lines if "Warning" in line] or lines[-1:]


MOUNTED = ["unshare", "-rm", "sh", "-c"]


def disks(home, right):
    """Disks that are full or read-only, mounted for one command."""
    if subprocess.run([*MOUNTED, "mount -t tmpfs none /mnt"], capture_output=True).returncode:
        return
    for name, size, ballast in (("full from the start", "512k", 0), ("full while it runs", "1200k", 1)):
        folder = home / name.replace(" ", "_")
        (folder / "out").mkdir(parents=True)
        text = faults.STUDY
        if ballast:
            # The third row writes all that is left.
            text = text.replace("    child = ", "    fill(x)\n    child = ") + FILL
        toy = Toy(folder, text)
        words = f'mount -t tmpfs -o size={size} none out && "$@"; s=$?; cp out/*.csv kept.csv 2>/dev/null; exit $s'
        done = subprocess.run(
            [*MOUNTED, words, "sh", *toy.words()],
            cwd=folder,
            env=toy.environment(TMPDIR=str(folder)),
            capture_output=True,
        )
        said = done.stderr.decode().strip()
        wrong = [f"status {done.returncode}"] if done.returncode != 2 else []
        wrong += [f"said {said!r}"] if "\n" in said or "No space left" not in said else []
        if ballast:
            wrong += _all_kept(folder, right[0])
        yield f"results folder {name}", 1, wrong, _short(said, folder)


FILL = """
def fill(x):
    from contextlib import suppress

    with suppress(OSError), open("out/ballast", "wb", buffering=0) as file:
        while x == 2.0:
            file.write(bytes(1000))
"""


def _all_kept(folder, rows):
    kept = {}
    for path in (folder / "kept.csv", *folder.glob("demheat-rows-*/*.csv")):
        if path.exists():
            kept |= {
                k: {n: v for n, v in r.items() if n not in faults.COSTS}
                for k, r in faults.store.read_rows(path).items()
            }
    lost = [key for key in list(rows)[:3] if key not in kept]
    code = {"code"}
    other = [k for k, r in kept.items() if any(r[n] != rows[k][n] for n in set(r) - code)]
    return [f"lost: {lost}"] * bool(lost) + [f"wrong: {other}"] * bool(other)


def caches(home):
    """Folders of kernels and packings that are full, read-only or broken: the number is that of whole ones."""
    kernels, packings = home / "kernels", home / "packings"
    there = {"NUMBA_CACHE_DIR": str(kernels), "DEMHEAT_CACHE": str(packings)}
    usual, _ = _solved([], there)
    yield "fresh caches", 1, [] if usual else ["no number"], usual
    for name, damage in DAMAGES.items():
        files = sorted(path for path in home.glob("[kp]*/**/*") if path.is_file())
        count = sum(damage(path) for path in files)
        found, said = _solved([], there)
        again, after = _solved([], there)
        wrong = [f"gives {found}"] * (found != usual) + [f"then {again}, {after}"] * (again != usual or after != [])
        yield f"{name} ({count} files)", 1, wrong, _short(" ".join(said), home)
    if subprocess.run([*MOUNTED, "mount -t tmpfs none /mnt"], capture_output=True).returncode == 0:
        yield from _mounted_caches(home, usual)


def _mounted_caches(home, usual):
    for name, words in {
        "kernels on a disk that is full": "mount -t tmpfs -o size=64k none kernels",
        "packings on a disk that is full": "mount -t tmpfs -o size=4k none packings",
        "both read-only": "mount -t tmpfs none kernels && mount -o remount,ro none kernels && "
        "mount -t tmpfs none packings && mount -o remount,ro none packings",
    }.items():
        env = os.environ | {"PYTHONPATH": str(ROOT), "DEMHEAT_WARM": "0"}
        env |= {"NUMBA_CACHE_DIR": str(home / "kernels"), "DEMHEAT_CACHE": str(home / "packings")}
        done = subprocess.run(
            [*MOUNTED, f'{words} && "$@"', "sh", sys.executable, "-c", SOLVE],
            cwd=home,
            env=env,
            capture_output=True,
            text=True,
        )
        said = [line for line in done.stderr.splitlines() if "Warning" in line]
        wrong = [f"gives {done.stdout}, {done.stderr[-300:]}"] if done.stdout != usual else []
        wrong += [f"said {len(said)} lines"] if len(said) > 2 else []
        yield name, 1, wrong, _short(" ".join(said), home)


def _cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    return True


def _flip(path):
    raw = bytearray(path.read_bytes())
    if raw:
        raw[len(raw) // 2] ^= 16
        path.write_bytes(raw)
    return bool(raw)


def _empty(path):
    path.write_bytes(b"")
    return True


def _index_only(path):
    return path.suffix == ".nbi" and _flip(path)


DAMAGES = {
    "files of both caches cut in two": _cut,
    "a bit of each file flipped": _flip,
    "files empty": _empty,
    "a bit of each index of kernels flipped": _index_only,
}


def _short(text, folder):
    return text.replace(str(folder), "...").replace(str(ROOT), "...")[-300:]


def page(lines, seed):
    """The page with what was found: (fault, times, wrong, note); what stands before and after its table stays."""
    table = ["| fault | times | wrong | what it said |", "|---|---|---|---|"]
    for name, times, wrong, note in lines:
        table.append(
            f"| {name} | {times} | {'; '.join(wrong)[:300].replace('|', '/') or 'nothing'} | {note.replace('|', '/')} |"
        )
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=ROOT)
    made = f"Made by `tests/tools/try_faults.py` at commit {commit.stdout.strip()} on {date.today().isoformat()}"
    text = PAGE.read_text(encoding="utf-8")
    head, tail = text[: text.index("Made by ")], text[text.index("\n## ") :]
    lines = [f"{made}, seed {seed}; nothing in the table is typed by hand.", "", *table, ""]
    return head + "\n".join(lines) + tail


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="faults-") as folder:
        home = Path(folder)
        right = faults.unkilled(home / "right")
        lines = [kills(home, right, arguments.kills, arguments.seed), at_one_time(home, right)]
        for found in (odd(home, right), disks(home, right), caches(home)):
            for line in found:
                print(line, flush=True)
                lines.append(line)
                # Now: what is stopped keeps what it has found.
                PAGE.write_text(page(lines, arguments.seed), encoding="utf-8")
    return any(wrong for _, _, wrong, _ in lines)


if __name__ == "__main__":
    sys.exit(main())
