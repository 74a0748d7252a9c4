"""The hash of the code that a row runs."""

import textwrap

import pytest

from studies import provenance

ONE = "LIMIT = 2\nSTEP = 1\ndef run():\n    return STEP\ndef plot():\n    return LIMIT\n"


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """Small source tree of ours to hash; returns (write(file, text), hash())."""
    monkeypatch.setattr(provenance, "ROOT", tmp_path)

    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(textwrap.dedent(text))
        provenance.code_hash.cache_clear()
        provenance._parse.cache_clear()

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


def test_code_hash_follows_the_packages_own_function(tree):
    write, code = tree
    write("studies/one.py", "def run():\n    from demheat import solve\n    return solve()")
    before = code("")
    write("demheat/inner.py", "thing = 2")
    assert code("") != before
