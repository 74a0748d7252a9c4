from demheat import blocks as module
from demheat.blocks import blocks


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
    assert lengths[:4] == [1, 2, 4, 8] and max(lengths) == 8
    # Dear from the first on: none is shorter than that.
    assert {end - begin for begin, end in cut(monkeypatch, 12, 4, lambda n: 1.0 * n)} == {4}
    # Dear after the 600th: from there on they are halved.
    later = cut(
        monkeypatch, 1000, 1, lambda n, left=[600]: left.__setitem__(0, left[0] - n) or (left[0] < 0) * n * 0.01
    )
    assert later[-1][1] == 1000 and max(end - begin for begin, end in later[-8:]) <= 16
