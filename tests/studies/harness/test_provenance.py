"""What a row says of the code that has made it."""

import subprocess
from types import ModuleType

import pytest

from studies.harness import provenance


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository of ours with one commit; returns what runs git in it and forgets what was seen."""

    def git(*words):
        for seen in (provenance._head, provenance._differences, provenance._alike):
            seen.cache_clear()
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        return subprocess.run(["git", *who, *words], cwd=tmp_path, check=True, capture_output=True, text=True).stdout

    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    (tmp_path / "demheat").mkdir()
    (tmp_path / "demheat" / "dem.py").write_text("A = 1\n")
    git("init", "-q")
    git("add", ".")
    git("commit", "-qm", "one")
    yield tmp_path, git
    for seen in (provenance._head, provenance._differences, provenance._alike):
        seen.cache_clear()


def test_a_commit_and_what_differs_from_it(repository):
    root, git = repository
    clean = provenance.commit()
    assert len(clean) == 10 and "+" not in clean and provenance.of_this_code(clean)
    (root / "demheat" / "dem.py").write_text("A = 2\n")
    git("status")
    changed = provenance.commit()
    assert changed.startswith(f"{clean}+") and not provenance.of_this_code(clean)
    # A killed run goes on where it was, another change is another code.
    assert provenance.of_this_code(changed)
    (root / "demheat" / "new.py").write_text("B = 1\n")
    git("status")
    assert provenance.commit().startswith(f"{clean}+") and not provenance.of_this_code(changed)


def test_a_commit_that_changes_no_code_is_the_same_code(repository):
    root, git = repository
    first = provenance.commit()
    (root / "results").mkdir()
    (root / "results" / "rows.csv").write_text("case\n")
    git("add", ".")
    git("commit", "-qm", "rows")
    assert provenance.commit() != first and provenance.of_this_code(first)
    (root / "demheat" / "dem.py").write_text("A = 2\n")
    git("commit", "-qam", "two")
    assert not provenance.of_this_code(first)
    assert not provenance.of_this_code("0123456789") and not provenance.of_this_code("")


@pytest.mark.parametrize(
    "text, same, committed",
    [
        ("# A word.\nA = 1  # another\n", True, True),
        ('"""Text."""\n\nA = 1\n', True, False),
        ('A = "1"\n', False, True),
        ('A = 1\nFAILS = {"error": "its order"}\nREASONS = {}\n', True, True),
        ("FAILS = A = 1\n", False, True),
        ("FAILS, A = 1, 1\n", False, True),
        ('A = 1\n"""Text."""\n', False, False),
        ("A =\n", False, False),
    ],
)
def test_comments_docstrings_and_sentences_about_claims_do_no_work(repository, text, same, committed):
    root, git = repository
    first = provenance.commit()
    (root / "demheat" / "dem.py").write_text(text)
    git(*(("commit", "-qam", "two") if committed else ("status",)))
    assert provenance.commit() != first and provenance.of_this_code(first) == same
    # Of a study that is not ours nothing says what it was then.
    strange = root.parent / "mine.py"
    strange.write_text("X = 1\n")
    assert not provenance.of_this_code(first, strange)


def test_docstrings_of_classes_and_functions_do_no_work(repository):
    root, git = repository
    path = root / "demheat" / "dem.py"
    path.write_text('class A:\n    """A."""\n\n    def b(self):\n        """B."""\n        return 1\n')
    git("commit", "-qam", "two")
    first = provenance.commit()
    path.write_text('class A:\n    """C."""\n\n    def b(self):\n        return 1\n')
    git("status")
    assert provenance.of_this_code(first)
    path.write_text('class A:\n    """C."""\n\n    def b(self):\n        return 2\n')
    git("status")
    assert not provenance.of_this_code(first)


@pytest.mark.parametrize("how", ["gone", "new", "new and unknown", "a table"])
def test_files_that_come_or_go_do_work(repository, how):
    root, git = repository
    (root / "demheat" / "table.csv").write_text("1\n")
    git("add", ".")
    git("commit", "-qm", "a table")
    first = provenance.commit()
    if how == "gone":
        (root / "demheat" / "dem.py").unlink()
    else:
        (root / "demheat" / ("table.csv" if how == "a table" else "new.py")).write_text("# Words.\n1\n")
    git(*(("add", ".") if how == "new" else ("status",)))
    assert not provenance.of_this_code(first)


def test_outside_a_repository_the_source_tells(tmp_path, repository, monkeypatch):
    root, git = repository
    (root / ".git").rename(root / "gone")
    git_less = [provenance._head, provenance._differences]
    for seen in git_less:
        seen.cache_clear()
    before = provenance.commit()
    assert before.startswith("+")
    (root / "demheat" / "dem.py").write_text("A = 2\n")
    provenance._differences.cache_clear()
    assert provenance.commit() != before


def test_a_study_of_somebody_elses_counts_by_its_bytes(repository, tmp_path):
    file = tmp_path / "mine.py"
    file.write_text("X = 1\n")
    before = provenance.commit(file)
    assert before.startswith(f"{provenance.commit()}+")
    file.write_text("X = 2\n")
    assert provenance.commit(file) != before


def test_the_module_of_a_case():
    study = ModuleType("study")
    study.MODULES = {"lsa": "demheat.packing.lsa"}
    paths = {"fem": "references.fem", "dem": "demheat.dem", "lsa": "demheat.packing.lsa", "": ""}
    assert {name: provenance.module_of(study, name) for name in paths} == paths
    with pytest.raises(ValueError, match="method = 'femm' of study: neither a method nor in its MODULES"):
        provenance.module_of(study, "femm")
