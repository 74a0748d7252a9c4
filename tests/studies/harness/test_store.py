"""Rows in a file: whole or not at all, columns in order."""

import csv
import threading
import time

import pytest

from demheat.runtime.paths import locked, replaced
from studies.harness import store


def test_csv_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "rows.csv"
    store.write_rows(path, [{"case": "a", "value": 0.1 + 0.2, "note": 'comma, "quote"\nand line'}])
    assert store.read_rows(path)["a"] == {"case": "a", "value": repr(0.1 + 0.2), "note": 'comma, "quote"\nand line'}
    before = path.read_bytes()
    with path.open("rb") as reader:  # a reader at this moment still sees the old file, whole
        store.write_rows(path, [{"case": "b"}])
        assert reader.read() == before and list(store.read_rows(path)) == ["b"]
    before = path.read_bytes()
    with pytest.raises(ZeroDivisionError), replaced(path) as temporary:
        temporary.write_text("half a fi")
        raise ZeroDivisionError
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_columns_come_in_order(tmp_path):
    path = tmp_path / "rows.csv"
    store.write_rows(path, [{"case": "a", "x": 1, "status": "ok", "y": 2}, {"case": "b", "wall_s": 1.0, "z": 3}])
    with path.open() as file:
        assert next(csv.reader(file)) == ["case", "x", "y", "z", "wall_s", "status"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no column 'case'"),
        (b"name,x\na,1\n", "no column 'case'"),
        (b"case,x\na,1\nb\n", "row 2 has not as many values"),
        (b"case,x\na,1,2\n", "row 1 has not as many values"),
        (b'case,x\na,"1\n', "unexpected end of data"),
        (b"case,x\na,1\nb,1\na,2\n", "two rows of 'a'"),
        (b"case,x\na,\xff\xfe\n", "utf-8"),
    ],
)
def test_a_broken_file_is_named(tmp_path, content, said):
    path = tmp_path / "rows.csv"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=f"rows.csv: must hold rows of a study as CSV: .*{said}"):
        store.read_rows(path)


def test_a_folder_is_no_file_of_rows(tmp_path):
    with pytest.raises(ValueError, match="must hold rows of a study as CSV"):
        store.read_rows(tmp_path)


def test_writers_take_turns(tmp_path):
    """Rows of two writers, each of whom reads before the other has written if nobody waits."""
    path, inside, keys = tmp_path / "rows.csv", threading.Event(), [f"k{n}" for n in range(2)]

    def other():
        inside.set()
        store.add_rows(path, {"k1": {"case": "k1"}}, keys)

    second = threading.Thread(target=other)
    with locked(tmp_path):
        rows = store.read_rows(path)
        second.start()
        inside.wait(10)
        time.sleep(0.1)  # it would be done by now
        assert not path.exists()
        store.write_rows(path, [*rows.values(), {"case": "k0"}])
    second.join(10)
    assert list(store.read_rows(path)) == keys


def test_rows_that_cannot_be_written_are_kept_elsewhere(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(store.tempfile, "tempdir", None)
    (tmp_path / "out").write_text("no folder")
    with pytest.raises(ValueError, match="cannot be written: .*; the rows are in ") as raised:
        store.add_rows(tmp_path / "out" / "rows.csv", {"a": {"case": "a", "x": 1}}, ["a"])
    kept = str(raised.value).rpartition(" ")[2]
    assert store.read_rows(kept) == {"a": {"case": "a", "x": "1"}}


def test_a_picture_is_one_cell(tmp_path):
    """200 x 200 numbers, more letters than the csv module reads by default."""
    text = " ".join(["12.345"] * 40_000)
    store.write_rows(tmp_path / "rows.csv", [{"case": "a", "picture": text}])
    assert store.read_rows(tmp_path / "rows.csv")["a"]["picture"] == text
