"""Only here: two methods of one name, and modules loaded that declare none."""

import pytest

from demheat import declared


def test_two_methods_of_one_name_are_refused(tmp_path, monkeypatch):
    home = tmp_path / f"home_{tmp_path.name}"
    home.mkdir()
    source = "from demheat.method import Method\nMETHODS = (Method(name='one', title='one'),)\n"
    for name, text in (("__init__", ""), ("first", source), ("second", source), ("other", "raise RuntimeError")):
        (home / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(declared, "HOMES", (home.name,))
    with pytest.raises(ValueError, match="methods \\['one', 'one'\\]: declared more than once"):
        declared.all_methods.__wrapped__()
    (home / "second.py").unlink()
    # Modules that declare nothing are not loaded.
    assert [method.module for method in declared.all_methods.__wrapped__().values()] == ["first"]


def test_modules_are_known_by_the_last_part_of_their_names():
    assert declared.path_of("fem") == "references.fem" and declared.path_of("dem") == "demheat.dem"
    assert declared.path_of("") == declared.path_of("none") == ""
    with pytest.raises(ValueError, match="method = 'none': must be a module of demheat or references"):
        declared.load("none")
