"""Only here: packings on disk that are taken for others, believed when damaged, or half written."""

import json
import threading
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing import kept
from demheat.packing.base import make_packing
from demheat.packing.cache import relaxed
from demheat.packing.kept import cache_folder, cached
from demheat.packing.radii import Gaussian, Uniform


class Maker:
    """Counts how often it is asked."""

    def __init__(self, seed=0):
        self.calls, self.seed = 0, seed

    def __call__(self):
        self.calls += 1
        rng = np.random.default_rng(self.seed)
        return make_packing(
            rng.random((20, 3)), rng.uniform(0.01, 0.02, 20), (1, 1, 1), (True, False, True), {"a": [1]}
        )


def same(first, second):
    for name in ("centers", "radii", "size", "periodic"):
        one, two = getattr(first, name), getattr(second, name)
        assert_array_equal(one, two)
        assert one.dtype == two.dtype


def test_made_once(tmp_path):
    make = Maker()
    first = cached(make, {"seed": 0}, folder=tmp_path)
    second = cached(make, {"seed": 0}, folder=tmp_path)
    assert make.calls == 1
    same(first, second)
    assert first.provenance == {"a": [1], "cached": False} and second.provenance == {"a": [1], "cached": True}
    assert [path.suffix for path in tmp_path.iterdir()] == [".npz"]


def test_two_that_make_the_same_at_once_both_have_it(tmp_path):
    """As two machines do that share a folder: both have looked before either writes."""
    both = threading.Barrier(2, timeout=20)

    def make():
        both.wait()
        return Maker()()

    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(lambda _: cached(make, {"seed": 0}, folder=tmp_path), range(2))
    same(first, second)
    assert [path.suffix for path in tmp_path.iterdir()] == [".npz"]
    kept = cached(Maker(), {"seed": 0}, folder=tmp_path)
    same(first, kept)
    assert kept.provenance["cached"]


def test_a_file_under_the_wrong_name_is_not_believed(tmp_path):
    """Two keys with one digest must not give one packing: the key inside the file decides."""
    cached(Maker(0), {"seed": 0}, folder=tmp_path)
    (path,) = tmp_path.iterdir()
    cached(Maker(1), {"seed": 1}, folder=tmp_path)
    (other,) = set(tmp_path.iterdir()) - {path}
    path.replace(other)
    make = Maker(1)
    again = cached(make, {"seed": 1}, folder=tmp_path)
    assert make.calls == 1
    same(again, Maker(1)())


@pytest.mark.parametrize("damage", [lambda raw: b"", lambda raw: raw[: len(raw) // 2]])
def test_a_damaged_file_is_made_again(tmp_path, damage):
    make = Maker()
    first = cached(make, {}, folder=tmp_path)
    (path,) = tmp_path.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    with pytest.warns(UserWarning, match="made again"):
        second = cached(make, {}, folder=tmp_path)
    assert make.calls == 2
    same(first, second)
    assert cached(make, {}, folder=tmp_path).provenance["cached"]


def test_a_killed_write_leaves_nothing(tmp_path, monkeypatch):
    def killed(file, **arrays):
        file.write(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(kept.np, "savez", killed)
    with pytest.raises(KeyboardInterrupt):
        cached(Maker(), {}, folder=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_said(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.warns(UserWarning, match="not cached"):
        packing = cached(Maker(), {}, folder=blocked / "below")
    same(packing, Maker()())


def test_folder(monkeypatch, tmp_path):
    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path / "mine"))
    assert cache_folder() == tmp_path / "mine"
    monkeypatch.delenv("DEMHEAT_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "demheat" / "packings"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "demheat" / "packings"


def test_relaxed_scales_one_packing(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        unit = relaxed(200, steps=10, folder=tmp_path)
        small = relaxed(200, size=(0.1, 0.1, 0.1), steps=10, folder=tmp_path)
    assert not unit.provenance["cached"] and small.provenance["cached"]
    assert_allclose(small.centers, 0.1 * unit.centers, rtol=1e-15)
    assert small.size.tolist() == [0.1, 0.1, 0.1]
    assert_allclose(small.phi, 0.64, rtol=1e-13)  # rounding of sums
    slab = relaxed(200, size=(0.1, 0.2, 0.3), phi=0.5, steps=10, folder=tmp_path)
    again = relaxed(200, size=(1, 2, 3), phi=0.5, steps=10, folder=tmp_path)
    assert not slab.provenance["cached"] and again.provenance["cached"]
    assert slab.size.tolist() == [0.1, 0.2, 0.3]
    assert np.all(slab.centers <= slab.size)
    assert_allclose(slab.phi, 0.5, rtol=1e-13)


@pytest.mark.parametrize(
    "change",
    [
        {"number": 201},
        {"phi": 0.63},
        {"seed": 1},
        {"periodic": False},
        {"periodic": (True, True, False)},
        {"radii": Gaussian(0.29)},
        {"radii": Uniform(0.3)},
        {"size": (1, 1, 1.001)},
        {"steps": 6},
        {"overlap": 0.003},
    ],
)
def test_whatever_changes_the_packing_changes_the_key(tmp_path, change):
    usual = {"number": 200, "steps": 5}
    relaxed(**usual, folder=tmp_path)
    assert relaxed(**usual, folder=tmp_path).provenance["cached"]
    assert not relaxed(**(usual | change), folder=tmp_path).provenance["cached"]


def test_numpy_numbers_are_numbers(tmp_path):
    relaxed(200, steps=5, folder=tmp_path)
    assert relaxed(np.int64(200), steps=np.int32(5), seed=np.uint8(0), folder=tmp_path).provenance["cached"]
    with pytest.raises(TypeError, match="must be what JSON can hold"):
        cached(Maker(), {"key": object()}, folder=tmp_path)


def test_new_code_retires_old_packings(tmp_path, monkeypatch):
    relaxed(200, steps=5, folder=tmp_path)
    monkeypatch.setattr("demheat.packing.cache.code_hash", lambda *modules: "newer")
    assert not relaxed(200, steps=5, folder=tmp_path).provenance["cached"]


def test_no_flipped_bit_loads_another_packing_or_raises(tmp_path):
    """A bit of each seventh byte, names and shapes of the arrays included: the file is whole or made again."""
    made = cached(Maker(), {}, folder=tmp_path)
    (path,) = tmp_path.iterdir()
    raw, text = path.read_bytes(), json.dumps({"format": kept.FORMAT})
    noticed = 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for place in range(0, len(raw), 7):
            path.write_bytes(raw[:place] + bytes([raw[place] ^ 1 << place % 8]) + raw[place + 1 :])
            found = kept._load(path, text)
            noticed += found is None
            if found is not None:
                same(made, found)
                assert found.provenance == {"a": [1]} and found.domain == "box"
    # The rest are dates of members and the like.
    assert noticed > 0.5 * len(raw) / 7


def test_a_changed_archive_that_is_whole_is_noticed(tmp_path):
    """Its members fit their own checksums, but not the one over all."""
    cached(Maker(), {}, folder=tmp_path)
    (path,) = tmp_path.iterdir()
    raw = path.read_bytes()
    with np.load(path) as stored:
        arrays = dict(stored)
    np.savez(path, **arrays | {"radii": arrays["radii"] * 2})
    make = Maker()
    with pytest.warns(UserWarning, match="made again: the checksum does not fit"):
        cached(make, {}, folder=tmp_path)
    assert make.calls == 1 and path.read_bytes() == raw


def test_without_any_home_packings_are_made_and_a_line_says_so(monkeypatch):
    def nobody(path):
        raise RuntimeError("no home.")

    monkeypatch.delenv("DEMHEAT_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(kept.Path, "expanduser", nobody)
    with pytest.warns(UserWarning, match="packing not cached: no home. Set DEMHEAT_CACHE"):
        packing = cached(Maker(), {})
    same(packing, Maker()())
    assert not packing.provenance["cached"]


def test_whether_few_are_allowed_makes_no_other_packing(tmp_path):
    relaxed(200, seed=1, folder=tmp_path)
    assert relaxed(200, seed=1, allow_few=True, folder=tmp_path).provenance["cached"]
