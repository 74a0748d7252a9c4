"""What a row says of the code that has made it."""

import subprocess
from types import ModuleType

import pytest

from studies.harness import making, provenance


def forget():
    """What was seen of a repository, which no process of a row sees change."""
    own = (provenance._head, provenance._differences, provenance._alike, provenance._works_alike)
    for seen in (*own, making.paths_of, making._imported):
        seen.cache_clear()


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository of ours with one commit; returns what runs git in it and forgets what was seen."""

    def git(*words):
        forget()
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        return subprocess.run(["git", *who, *words], cwd=tmp_path, check=True, capture_output=True, text=True).stdout

    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    (tmp_path / "demheat").mkdir()
    (tmp_path / "demheat" / "dem.py").write_text("A = 1\n")
    git("init", "-q")
    git("add", ".")
    git("commit", "-qm", "one")
    yield tmp_path, git
    forget()


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
    forget()
    before = provenance.commit()
    assert before.startswith("+")
    (root / "demheat" / "dem.py").write_text("A = 2\n")
    provenance._differences.cache_clear()
    assert provenance.commit() != before


STUDIES = {
    "mine/__init__.py": "from studies.harness import cost\n\n\ndef plot(df):\n    from studies.mine import figure\n",
    "mine/figure.py": "from studies.drawn import A\n",
    "mine/tables.py": "A = 1\n",
    "mine/rows.py": "def run():\n    import studies.other.rows\n",
    "mine/known.csv": "1\n",
    "other/__init__.py": "from studies.other.tables import A\n",
    "other/rows.py": 'MODULES = {"a": "studies.named.rows"}\n',
    "other/figure.py": "A = 1\n",
    "other/tables.py": "from studies.told.rows import A\n",
    "told/rows.py": "A = 1\n",
    "named/rows.py": "A = 1\n",
    "alone.py": "A = 1\n",
    "drawn.py": "A = 1\n",
    "common/block.py": "A = 1\n",
    "paper/mine.csv": "1\n",
    "harness/cost.py": "A = 1\n",
    "harness/report.py": "from studies.alone import A\n",
}
# Which of these another study's rows, or a folder's own, do not depend on.
OF_MINE = ("mine/__init__.py", "mine/rows.py", "mine/known.csv", "other/__init__.py", "other/rows.py")
OF_MINE += ("other/tables.py", "told/rows.py", "named/rows.py", "common/block.py", "paper/mine.csv", "harness/cost.py")


@pytest.fixture
def studied(repository):
    """The same with studies, at a second commit."""
    root, git = repository
    for name, text in STUDIES.items():
        path = root / "studies" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    git("add", ".")
    git("commit", "-qm", "studies")
    return root, git


@pytest.mark.parametrize("committed", [True, False])
@pytest.mark.parametrize("name", STUDIES)
def test_rows_are_of_other_code_where_that_makes_them(studied, name, committed):
    root, git = studied
    files = {"mine": root / "studies" / "mine" / "__init__.py", "alone": root / "studies" / "alone.py"}
    first = {each: provenance.commit(file) for each, file in files.items()}
    assert set(first.values()) == {provenance.commit()}
    path = root / "studies" / name
    path.write_text(f"{path.read_text()}B = 2\n")
    git(*(("commit", "-qam", "two") if committed else ("status",)))
    moved = {"mine": name in OF_MINE, "alone": name.startswith(("alone", "common", "paper", "harness/cost"))}
    for each, file in files.items():
        assert provenance.of_this_code(first[each], file) is not moved[each]
        assert ("+" in provenance.commit(file)) is (moved[each] and not committed)
    # Where nobody says which study, any may be.
    assert not provenance.of_this_code(first["mine"])


@pytest.mark.parametrize("name", ["mine/new.py", "common/new.csv", "alone/new.py"])
def test_files_that_come_count_by_the_same_rule(studied, name):
    root, git = studied
    file = root / "studies" / "mine" / "__init__.py"
    first, path = provenance.commit(file), root / "studies" / name
    path.parent.mkdir(exist_ok=True)
    path.write_text("A = 1\n")
    git("status")
    assert provenance.of_this_code(first, file) is name.startswith("alone")


def test_outside_a_repository_the_same_files_tell(studied):
    root, _ = studied
    (root / ".git").rename(root / "gone")
    file = root / "studies" / "mine" / "__init__.py"
    found = set()
    for name in ("mine/figure.py", "alone.py", "harness/report.py", "other/tables.py", "mine/rows.py"):
        forget()
        (root / "studies" / name).write_text("B = 2\n")
        found.add((name in OF_MINE, provenance.commit(file)))
    assert len(found) == 3 and len({commit for own, commit in found if not own}) == 1


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
