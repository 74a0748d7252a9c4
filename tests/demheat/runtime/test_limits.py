"""Only here: free memory read wrongly of what systems tell, and limits that let twice as much pass."""

import math

import pytest

from demheat.runtime import limits


def told(root, meminfo=None, cgroup=None, **groups):
    """A tree of files as Linux shows it; groups by their folder, "." for "/"."""
    files = {"proc/meminfo": meminfo, "proc/self/cgroup": cgroup}
    for folder, of_group in groups.items():
        files |= {f"sys/fs/cgroup/{folder.replace('_', '/')}/{name}": text for name, text in of_group.items()}
    for name, text in files.items():
        if text is not None:
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
    return limits.free_memory(root)


MEMINFO = "MemTotal: 9000 kB\nMemFree: 100 kB\nMemAvailable: 5000 kB\n"


def version_2(most, used, kept=0):
    return {"memory.max": most, "memory.current": used, "memory.stat": f"anon 1\ninactive_file {kept}\n"}


def test_machine_alone(tmp_path):
    assert told(tmp_path, MEMINFO) == 5000 * 1024


def test_without_linux_all_that_is_built_in(tmp_path):
    assert 2**20 < told(tmp_path) < math.inf


def test_groups_of_version_2_and_those_that_hold_them(tmp_path):
    groups = {"a": version_2("3000000", "1000000", 500), "a_b": version_2("max", "700")}
    assert told(tmp_path, MEMINFO, "0::/a/b\n", **groups) == 2_000_500
    # The path of the host, seen from inside a container.
    inside = {"": version_2("90000", "40000")}
    assert told(tmp_path / "inside", MEMINFO, "0::/host/a/b\n", **inside) == 50_000


def test_groups_of_version_1(tmp_path):
    group = {"memory.limit_in_bytes": "9000", "memory.usage_in_bytes": "4000", "memory.stat": "total_inactive_file 5"}
    assert told(tmp_path, MEMINFO, "3:cpu:/\n4:memory:/c\n0::/\n", memory_c=group) == 5005


def test_more_than_the_limit_leaves_nothing(tmp_path):
    assert told(tmp_path, MEMINFO, "0::/a\n", a=version_2("10", "900")) == 0


def test_a_refusal_says_both_numbers_and_what_fits(monkeypatch):
    monkeypatch.setattr(limits, "free_memory", lambda: 2.0 * limits.GIB)
    limits.check_memory("n", 100, 2 * limits.GIB)
    with pytest.raises(ValueError, match=r"n = 100: takes 16 GiB .* 2 GiB are free; must be at most about 50 here"):
        limits.check_memory("n", 100, 16 * limits.GIB, power=3)
    with pytest.raises(ValueError, match=r"must be about 0.5 of that along each here"):
        limits.check_memory("n", (9, 9, 9), 16 * limits.GIB, power=3)
    with pytest.raises(ValueError, match=r"n = 100000000000\.\.\. \(401 characters\): .* at most about 2.15e\+07 here"):
        limits.check_memory("n", 10**400, 10**402)


@pytest.mark.parametrize("check", [lambda n: limits.check_memory("n", 1, n), lambda n: limits.check_free("file", n)])
def test_all_that_is_free_may_be_taken_and_no_more(monkeypatch, check):
    monkeypatch.setattr(limits, "free_memory", lambda: 2.0 * limits.GIB)
    check(2 * limits.GIB)
    with pytest.raises(ValueError, match="takes 2 GiB of memory or more, and 2 GiB are free"):
        check(2 * limits.GIB + 1)


def test_little_is_not_looked_up(monkeypatch):
    monkeypatch.setattr(limits, "free_memory", None)
    limits.check_memory("n", 100, limits.SMALL)


def test_more_than_a_day_is_refused():
    limits.check_steps("step", 1.0, 86_000, 1.0, remedy="larger")
    for steps in (87_000, math.inf, math.nan):
        with pytest.raises(ValueError, match=r"more than a day; at most 8.6e\+04 are possible: must be larger"):
            limits.check_steps("step", 1.0, steps, 1.0, remedy="larger")
