"""The hash of the code that a row runs."""

import ast
import textwrap
from types import ModuleType

import pytest

from studies.harness import provenance

ONE = "LIMIT = 2\nSTEP = 1\ndef run():\n    return STEP\ndef plot():\n    return LIMIT\n"


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """Small source tree of ours to hash; returns (write(file, text), hash())."""
    monkeypatch.setattr(provenance, "ROOT", tmp_path)

    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(textwrap.dedent(text))
        provenance.code_hash.cache_clear()
        provenance._parse.cache_clear()
        provenance._found.cache_clear()
        return tmp_path

    write(
        "demheat/__init__.py", "from demheat.scene import A\ndef __getattr__(name):\n    from demheat.dem import solve"
    )
    write("demheat/scene.py", "A = 1")
    write("demheat/dem.py", "import numpy\nfrom demheat.inner import thing")
    write("demheat/inner.py", "thing = 1")
    write("references/__init__.py", "")
    write("references/fft.py", "from demheat.scene import A")
    write("studies/__init__.py", "")
    write("studies/one.py", ONE)
    return write, lambda method: provenance.code_hash(tmp_path / "studies/one.py", method)


@pytest.mark.parametrize(
    ("file", "text", "method", "differs"),
    [
        ("references/fft.py", "from demheat.scene import A\nB = 1", "references.fft", True),
        ("references/fft.py", "from demheat.scene import A  # why", "references.fft", False),
        ("demheat/scene.py", "A = 2", "references.fft", True),
        ("demheat/inner.py", "thing = 2", "references.fft", False),
        ("demheat/inner.py", "thing = 2", "demheat.dem", True),
        ("studies/one.py", ONE.replace("LIMIT = 2", "LIMIT = 3"), "", False),
        ("studies/one.py", ONE.replace("return STEP", "'Why.'; return STEP"), "", False),
        ("studies/one.py", ONE.replace("return STEP", "return -STEP"), "", True),
        ("studies/one.py", ONE.replace("STEP = 1", "STEP = 2"), "", True),
    ],
)
def test_code_hash_covers_what_a_row_runs(tree, file, text, method, differs):
    write, code = tree
    before = code(method)
    write(file, text)
    assert (code(method) != before) == differs


def test_a_moved_module_keeps_the_hash(tree):
    """Neither the file's place nor the imports that say it count: what is computed does."""
    write, code = tree
    write("references/fft.py", "from demheat.scene import A\ndef solve():\n    return A")
    write("demheat/inner.py", "from demheat.scene import A\nthing = A")
    before = code("references.fft"), code("demheat.dem")
    root = write("demheat/deep/core.py", "from demheat.scene import A\nthing = A")
    (root / "demheat/inner.py").unlink()
    write("demheat/deep/__init__.py", '"""A folder."""')
    write("demheat/dem.py", "import numpy\nfrom demheat.deep.core import thing")
    (root / "references/fft.py").unlink()
    write("references/fft/__init__.py", '"""Why."""\nfrom references.fft.solver import solve\n__all__ = ["solve"]')
    write("references/fft/solver.py", "from demheat.scene import A\ndef solve():\n    return A")
    assert (code("references.fft"), code("demheat.dem")) == before
    write("demheat/deep/core.py", "from demheat.scene import A\nthing = -A")
    assert code("references.fft") == before[0] and code("demheat.dem") != before[1]


def test_claims_of_a_package_do_not_count(tree):
    """A study of several files: its parts lie below the module that has its claims."""
    write, _ = tree
    run = "def run():\n    from studies.two.rows import row\n    return row()\n"
    study = f"LIMIT = 2\nfrom studies.two.figure import draw\n{run}"
    root = write("studies/two/__init__.py", study)
    write("studies/two/rows.py", "def row():\n    return 1")
    write("studies/two/figure.py", "def draw():\n    return 1")
    before = provenance.code_hash(root / "studies/two/__init__.py")
    write("studies/two/figure.py", "def draw():\n    return 2")
    write("studies/two/__init__.py", study.replace("LIMIT = 2", "LIMIT = 3") + "def claims():\n    return LIMIT\n")
    assert provenance.code_hash(root / "studies/two/__init__.py") == before
    write("studies/two/rows.py", "def row():\n    return 2")
    assert provenance.code_hash(root / "studies/two/__init__.py") != before


def test_what_a_method_declares_of_itself_does_not_count(tree):
    write, code = tree
    before = code("references.fft")
    write("references/fft.py", "from demheat.scene import A\nMETHODS = (1, 2)")
    assert code("references.fft") == before


def test_the_module_of_a_case():
    study = ModuleType("study")
    study.MODULES = {"lsa": "demheat.packing.lsa"}
    paths = {"fem": "references.fem", "dem": "demheat.dem", "lsa": "demheat.packing.lsa", "": ""}
    assert {name: provenance.module_of(study, name) for name in paths} == paths
    with pytest.raises(ValueError, match="method = 'femm' of study: neither a method nor in its MODULES"):
        provenance.module_of(study, "femm")


def test_code_hash_follows_the_packages_own_function(tree):
    write, code = tree
    write("studies/one.py", "def run():\n    from demheat import solve\n    return solve()")
    before = code("")
    write("demheat/inner.py", "thing = 2")
    assert code("") != before


def test_the_books_of_rows_do_not_count(tree):
    """A row may name what it keeps on disk by the hash of some code; how that is made is not the row's."""
    write, code = tree
    write("studies/harness/__init__.py", "")
    write("studies/harness/provenance.py", "def code_hash():\n    return 1")
    write("studies/one.py", "def run():\n    from studies.harness.provenance import code_hash\n    return code_hash()")
    before = code("")
    write("studies/harness/provenance.py", "def code_hash():\n    return 2")
    assert code("") == before


INSIDE = (ast.Module, ast.stmt, ast.excepthandler, ast.match_case)
NESTED = """
class Body:
    async def inside(self):
        if 1:
            import one
        elif 2:
            import two
        else:
            import three
for k in ():
    import four
else:
    import five
try:
    import six
except OSError:
    import seven
else:
    import eight
finally:
    import nine
match 1:
    case 1:
        with 2:
            while 3:
                import ten
"""


def test_statements_inside_statements():
    tree = ast.parse(NESTED)
    assert {*provenance._statements(tree)} == {node for node in ast.walk(tree) if isinstance(node, INSIDE)}
    names = {part.names[0].name for part in provenance._imports_in(tree)}
    assert names == {"one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"}


def test_syntax_is_spelled_alike_on_every_python():
    """`ast.dump` writes fields that are empty on some versions, and `type_params` from 3.12 on."""
    tree = ast.parse("def area(radius):\n    return 3 * radius**2")
    name = "Name(id='radius', ctx=Load())"
    power = f"BinOp(left={name}, op=Pow(), right=Constant(value=2))"
    product = f"BinOp(left=Constant(value=3), op=Mult(), right={power})"
    said = f"FunctionDef(name='area', args=arguments(args=[arg(arg='radius')]), body=[Return(value={product})])"
    assert provenance.spelled(tree.body[0]) == said
    # None, False and 0 are no absence.
    values = ("None", "False", "0", "0.0", "''", "[]")
    assert len({provenance.spelled(ast.parse(f"x = {value}")) for value in values}) == len(values)
