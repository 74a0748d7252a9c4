"""Only here: spheres drawn with functions whose last bit hangs on the processor, and powers that are off."""

import ast
import importlib.util
import json
import math
import os
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from demheat.packing.dispersion import CODE
from demheat.powers import cube_root, cubed, exponential, power

TESTS = Path(__file__).parents[1]
# What NumPy computes by other code where a processor has AVX-512 or FMA (`numpy.lib.introspect.opt_func_info` says so),
# and what it leaves to BLAS, which has other code for every processor.
ELSEWHERE = {"power", "cbrt", "exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "sin", "cos", "tan"}
ELSEWHERE |= {"arcsin", "arccos", "arctan", "arctan2", "sinh", "cosh", "tanh", "arcsinh", "arccosh", "arctanh"}
ELSEWHERE |= {"dot", "vdot", "inner", "matmul", "tensordot", "einsum"}


def odd(source):
    """What in a source another processor would round otherwise: such functions, @, and powers but squares."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "np":
            yield from {node.attr} & ELSEWHERE
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield "@"
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            yield from [] if isinstance(node.right, ast.Constant) and node.right.value == 2 else ["**"]


@pytest.mark.parametrize("module", CODE)
def test_spheres_are_drawn_without_what_processors_round_otherwise(module):
    if module != "demheat.powers":
        assert list(odd(Path(importlib.util.find_spec(module).origin).read_text(encoding="utf-8"))) == []


def test_what_would_be_odd():
    assert list(odd("np.cbrt(x)")) == ["cbrt"] and list(odd("a @ b")) == ["@"]
    assert list(odd("radii**3")) == ["**"] == list(odd("2.0**x")) and list(odd("x**2 + np.sqrt(x)")) == []


def test_powers_are_right():
    x = np.random.default_rng(0).uniform(0.01, 10, 2000)
    exact = np.array([float(Fraction(each) ** 3) for each in x.tolist()])
    # The C library's powers are right to some 0.52 of a last bit, its roots to 4 by its manual: three times that cubed.
    assert np.all(np.abs(cubed(x) - exact) <= np.spacing(exact)) and np.mean(cubed(x) == exact) > 0.99
    assert cubed(0.3) == 0.3**3 and np.array_equal(power(3.0, x), [math.pow(3.0, each) for each in x.tolist()])
    assert np.array_equal(exponential(x), [math.exp(each) for each in x.tolist()])
    off = [abs(Fraction(cube_root(each)) ** 3 / Fraction(each) - 1) for each in x.tolist()]
    assert max(off) < 12 * np.finfo(float).eps
    assert cube_root(-8.0) == -2.0 and cube_root(0.0) == 0.0


def test_without_a_root_of_pythons_own(monkeypatch):
    """Python 3.10 has none."""
    monkeypatch.delattr(math, "cbrt", raising=False)
    assert cube_root(0.3) == pytest.approx(0.3 ** (1 / 3), rel=1e-15) and cube_root(-0.3) == -cube_root(0.3)


def plain():
    """Settings under which NumPy, Numba and BLAS see a processor without AVX, FMA and AVX-512."""
    found = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    return {"NPY_DISABLE_CPU_FEATURES": " ".join(found), "NUMBA_CPU_NAME": "generic", "OPENBLAS_CORETYPE": "Nehalem"}


@pytest.mark.slow
def test_the_same_seed_draws_the_same_spheres_on_a_plainer_processor():
    """Imitated on this one, in a process of its own; compiles for some twenty CPU-seconds, once."""
    found = []
    for settings in ({}, plain()):
        with tempfile.TemporaryDirectory() as folder:
            env = os.environ | settings | {"PYTHONPATH": str(TESTS.parent), "DEMHEAT_CACHE": folder}
            words = [sys.executable, str(TESTS / "drawn_bits.py")]
            done = subprocess.run(words, env=env, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr
        found.append(json.loads(done.stdout))
    assert len(found[0]) == len(set(found[0].values())) == 9
    assert found[1] == found[0]
