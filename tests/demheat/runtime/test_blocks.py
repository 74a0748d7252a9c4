"""Only here: loops in blocks that leave out a part, or are too long for a deadline."""

from demheat.runtime import blocks as module
from demheat.runtime.blocks import blocks


def cut(monkeypatch, number, first, seconds_of):
    now = [0.0]
    monkeypatch.setattr(module.time, "perf_counter", lambda: now[0])
    found = []
    for begin, end in blocks(number, first):
        now[0] += seconds_of(end - begin)
        found.append((begin, end))
    return found


def test_blocks_make_up_the_range(monkeypatch):
    for number in (1, 2, 7, 100):
        found = cut(monkeypatch, number, 3, lambda n: 1e-3)
        assert [i for begin, end in found for i in range(begin, end)] == list(range(number))
    assert cut(monkeypatch, 0, 3, lambda n: 1.0) == []


def test_blocks_grow_and_shrink_to_a_fraction_of_a_second(monkeypatch):
    lengths = [end - begin for begin, end in cut(monkeypatch, 1000, 1, lambda n: 0.01 * n)]
    # A tenth of a second each, to rounding, in the end.
    assert lengths[:4] == [1, 2, 4, 8] and set(lengths[4:-1]) <= {9, 10}
    # Dear from the first on: none is shorter than that.
    assert {end - begin for begin, end in cut(monkeypatch, 12, 4, lambda n: 1.0 * n)} == {4}
    # One long block after many cheap ones, then short ones.
    costs = iter([0.01] * 6 + [10.0] + [0.1] * 10**4)
    lengths = [end - begin for begin, end in cut(monkeypatch, 200, 1, lambda n: next(costs))]
    assert lengths[:8] == [1, 2, 4, 8, 16, 32, 64, 1]
