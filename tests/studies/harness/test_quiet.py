"""Who else uses the processors: told from the kernel's count, waited for, and written into rows."""

import itertools
import math
import os

import pytest

from studies.harness import quiet
from studies.harness.quiet import Moment

TICKS = os.sysconf("SC_CLK_TCK")


def test_what_is_not_ours_is_others(monkeypatch):
    monkeypatch.setattr(quiet, "processors", lambda: 2)
    begin = Moment(100.0, 50.0, 7.0)
    # Of 10 s on two processors 13 s were used, 8 s of them by us; a tick of each may be miscounted.
    assert quiet.others(begin, Moment(110.0, 63.0 + 2 / TICKS, 15.0)) == pytest.approx(0.25)
    # Ticks are coarse: no share is negative, and of a blink nobody knows.
    assert quiet.others(begin, Moment(110.0, 57.9, 15.0)) == 0.0
    assert math.isnan(quiet.others(begin, Moment(100.1, 50.2, 7.0)))
    assert math.isnan(quiet.others(begin, Moment(110.0, math.nan, 15.0)))


def test_only_our_processors_count_and_only_while_they_work(monkeypatch, tmp_path):
    def line(name, *ticks):
        return " ".join([name, *map(str, ticks)])

    ours = sorted(os.sched_getaffinity(0))
    #            user nice system idle iowait irq softirq steal guest guest_nice
    working = (100, 20, 3, 5000, 700, 4, 5, 6, 100, 20)
    lines = [line("cpu", *(9999,) * 10), *(line(f"cpu{k}", *working) for k in ours), line("cpu98765", *(7777,) * 10)]
    (tmp_path / "stat").write_text("\n".join([*lines, "intr 1 2 3", ""]))
    monkeypatch.setattr(quiet, "STAT", tmp_path / "stat")
    assert quiet.moment().busy == pytest.approx(len(ours) * (100 + 20 + 3 + 4 + 5 + 6) / TICKS)
    for text in ("", line("cpu0", "x") * 0 + "cpu 1 2 3 4 5 6 7 8\n"):
        (tmp_path / "stat").write_text(text)
        assert math.isnan(quiet.moment().busy)
    (tmp_path / "stat").unlink()
    assert math.isnan(quiet.moment().busy)


def test_the_loudest_of_those_that_are_known():
    assert quiet.loudest(0.1, math.nan, 0.30004) == 0.3
    assert math.isnan(quiet.loudest(math.nan, math.nan))


class Machine:
    """Others leave it after some looks; its clock goes on while one sleeps."""

    def __init__(self, monkeypatch, *shares):
        self.shares, self.time, self.said = list(shares), 0.0, []
        monkeypatch.setattr(quiet, "look", self.look)

    def look(self):
        return len(self.shares), self.shares.pop(0) if len(self.shares) > 1 else self.shares[0]

    def sleep(self, seconds):
        self.time += seconds

    def waiting(self, seconds):
        return quiet.waiting(seconds, self.said.append, clock=lambda: self.time, sleep=self.sleep)


def test_a_quiet_machine_is_not_waited_for(monkeypatch):
    machine = Machine(monkeypatch, 0.9)
    wait = machine.waiting(60)
    assert wait((1, 0.05)) == (1, 0.05) and wait((1, math.nan))[0] == 1
    assert machine.time == 0 and machine.said == []


def test_waits_until_others_are_gone(monkeypatch):
    machine = Machine(monkeypatch, 0.5, 0.3, 0.01)
    assert machine.waiting(60)((9, 0.5))[1] == 0.01
    assert machine.time == 3 * quiet.PAUSE
    (told,) = machine.said
    assert told.startswith("others use 50% of the processors, and costs") and "waiting for at most 60 s" in told


def test_patience_is_for_all_rows_together(monkeypatch):
    machine = Machine(monkeypatch, 0.5)
    wait = machine.waiting(5)
    assert wait((9, 0.5))[1] == 0.5 and machine.time == 6.0
    # Nothing is left of it.
    assert wait((9, 0.5))[1] == 0.5 and machine.time == 6.0
    assert len(machine.said) == 2 and "no more waiting" in machine.said[1]


def test_a_row_has_the_loudest_moment_around_it(monkeypatch):
    seen = iter([(10.0, 0.01), (11.0, 0.04), (12.0, 0.02), *[(13.0, 0.5)] * quiet.LOOKS])
    monkeypatch.setattr(quiet, "look", lambda: next(seen))
    during = iter([0.03, 0.06, 0.0])
    # Looks are old when the next row is done.
    clock = itertools.count(step=quiet.LASTS + 1).__next__
    computed = quiet.quietly(lambda *case: {"noise": next(during)}, clock=clock)
    rows = [computed("name", None, {}) for _ in range(3)]
    # What is seen after a row is seen before the next: four looks for three rows.
    assert [row["noise"] for row in rows] == [0.04, 0.06, 0.5]
    assert [row["triad_gbs"] for row in rows] == [10.0, 11.0, 12.0] and next(seen, None) is None


def test_a_blink_after_a_row_is_not_noise(monkeypatch):
    seen = iter([(10.0, 0.01), (11.0, 0.4), (12.0, 0.03)])
    monkeypatch.setattr(quiet, "look", lambda: next(seen))
    row = quiet.quietly(lambda *case: {"noise": math.nan})("name", None, {})
    assert row["noise"] == 0.03 and next(seen, None) is None


def test_where_nobody_knows_a_row_does_not_say(monkeypatch):
    monkeypatch.setattr(quiet, "look", lambda: (10.0, math.nan))
    assert quiet.quietly(lambda *case: {"x": 1})("name", None, {}) == {"x": 1, "triad_gbs": 10.0}


def test_a_look_takes_long_enough_to_tell(monkeypatch):
    monkeypatch.setattr(quiet, "triad_gbs", lambda **knobs: 12.345)
    slept = []
    monkeypatch.setattr(quiet.time, "sleep", slept.append)
    bandwidth, share = quiet.look()
    assert bandwidth == 12.3 and len(slept) == 1 and 0 < slept[0] <= quiet.SHORTEST
    # It did not sleep: too short.
    assert math.isnan(share)


def test_a_look_is_good_for_rows_that_are_quiet_themselves(monkeypatch):
    seen = iter([(10.0, 0.01), (11.0, 0.02), (12.0, 0.03)])
    monkeypatch.setattr(quiet, "look", lambda: next(seen))
    during = iter([0.03, 0.04, 0.2, math.nan, 0.0])
    time = iter([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 100.0, 101.0])
    computed = quiet.quietly(lambda *case: {"noise": next(during)}, clock=lambda: next(time))
    first, second, loud = (computed("name", None, {}) for _ in range(3))
    assert (first["noise"], second["noise"], loud["noise"]) == (0.03, 0.04, 0.2)
    # Two rows without a look, one that was loud and has one.
    assert [row["triad_gbs"] for row in (first, second, loud)] == [10.0, 10.0, 10.0]
    assert next(seen) == (12.0, 0.03)
