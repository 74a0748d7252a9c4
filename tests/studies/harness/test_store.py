"""Rows in a file: whole or not at all, columns in order."""

import csv

import pytest

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
    with pytest.raises(ZeroDivisionError), store.replaced(path) as temporary:
        temporary.write_text("half a fi")
        raise ZeroDivisionError
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_columns_come_in_order(tmp_path):
    path = tmp_path / "rows.csv"
    store.write_rows(path, [{"case": "a", "x": 1, "status": "ok", "y": 2}, {"case": "b", "wall_s": 1.0, "z": 3}])
    with path.open() as file:
        assert next(csv.reader(file)) == ["case", "x", "y", "z", "wall_s", "status"]
