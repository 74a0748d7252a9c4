"""The referee scores everything: no study defines an error of temperature, flux or conductivity."""

import ast
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"
FIELDS = {"temperature_at", "flux_at"}
QUANTITIES = {"temperature", "flux", "conductivity", "k_ratio", "mean_flux"}
# Where the same arithmetic says something else, and what.
EXCEPTIONS = {
    ("common/field_errors.py", "field_pictures"): "temperature over that of the coldest wall",
    ("damage/means.py", "theory"): "share of links that is left",
    ("damage/means.py", "first_loss"): "share of the conductivity that is lost",
    ("damage/means.py", "above_bound"): "distance to a bound",
    ("fig15_16_fields/halos.py", "ball"): "heights of points in a ball",
    ("harness/repeated.py", "measured_again"): "spread of seconds",
    ("packings/rows.py", "_z_of_gap"): "gap between two spheres",
    ("peers/means.py", "same_mesh"): "two programs on one mesh",
    ("peers/programs/freefem.py", "solve"): "two outputs of one program",
    ("peers/programs/getdp.py", "solve"): "two outputs of one program",
    ("peers/programs/multivoro.py", "solve"): "two programs that cut the same cells",
    ("peers/programs/openfoam.py", "solve"): "heat in and heat out",
    ("peers/python_elements.py", "solved"): "two outputs of one program",
    ("scaling/__init__.py", "_ranked"): "one body on one rank and on two",
    ("sphere_benchmark/rows.py", "_at_points"): "flux at points of a file, over the mean one",
    ("zeta2/figure.py", "_two_point"): "tangent of the two-point probability",
}


def words(node):
    """Names, attributes and keys in an expression."""
    for part in ast.walk(node):
        if isinstance(part, ast.Name):
            yield part.id
        elif isinstance(part, ast.Attribute):
            yield part.attr
        elif isinstance(part, ast.Constant) and isinstance(part.value, str):
            yield part.value


def is_one(node):
    return isinstance(node, ast.Constant) and node.value in (1, 1.0) and not isinstance(node.value, bool)


def is_quotient(node):
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div)


def is_relative_difference(node):
    """`a / b - 1`, `1 - a / b`, `(a - b) / b`, and `value - 1` of a conductivity that is a ratio already."""
    if not isinstance(node, ast.BinOp):
        return False
    left, right = node.left, node.right
    if isinstance(node.op, ast.Sub):
        ratio = (is_one(right) and left) or (is_one(left) and right)
        return bool(ratio) and (is_quotient(ratio) or bool(QUANTITIES & set(words(ratio))))
    if isinstance(node.op, ast.Div):
        difference = isinstance(left, ast.BinOp) and isinstance(left.op, ast.Sub)
        return difference and ast.dump(left.right) == ast.dump(right)
    return False


def is_difference_of_fields(node):
    """What one field has less what another one has, or a table's column less another's."""
    if not (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub)):
        return False
    sides = [set(words(side)) for side in (node.left, node.right)]
    either, both = sides[0] | sides[1], [bool(side & (QUANTITIES | FIELDS)) for side in sides]
    return bool(either & FIELDS) or all(both)


def is_root_mean_square(node):
    """`sqrt` of a mean, or of a weighted sum, of squares."""
    if not (isinstance(node, ast.Call) and "sqrt" in set(words(node.func))):
        return False
    parts = [part for argument in node.args for part in ast.walk(argument)]
    squared = any(isinstance(part, ast.BinOp) and isinstance(part.op, ast.Pow) for part in parts)
    dotted = any(isinstance(part, ast.BinOp) and isinstance(part.op, ast.MatMult) for part in parts)
    return squared and (dotted or bool({"mean", "average"} & {word for a in node.args for word in words(a)}))


RULES = (is_relative_difference, is_difference_of_fields, is_root_mean_square)


def own_errors(source, exceptions=()):
    """Lines of a study's source that work out an error by themselves."""
    tree = ast.parse(source)
    excused = {
        id(part)
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef) and function.name in exceptions
        for part in ast.walk(function)
    }
    nodes = (node for node in ast.walk(tree) if id(node) not in excused)
    return [f"{node.lineno}: {ast.unparse(node)}" for node in nodes if any(rule(node) for rule in RULES)]


def test_no_study_defines_an_error():
    found = {}
    for path in sorted(STUDIES.rglob("*.py")):
        name = str(path.relative_to(STUDIES))
        excused = {function for file, function in EXCEPTIONS if file == name}
        found[name] = own_errors(path.read_text(encoding="utf-8"), excused)
    assert len(found) > 200 and {name: lines for name, lines in found.items() if lines} == {}


def test_what_is_excused_is_there():
    for file, function in EXCEPTIONS:
        assert own_errors((STUDIES / file).read_text(encoding="utf-8")), (file, function)


@pytest.mark.parametrize(
    "source",
    [
        "e = 100 * (k / exact - 1)",
        "e = (found - right) / right",
        "e = rows['conductivity'].min() - 1",
        "e = field.temperature_at(x) - exact",
        "e = dem['k_ratio'] - fem['k_ratio']",
        "e = np.sqrt(np.mean(off**2))",
        "e = np.sqrt(volumes @ off**2 / volumes.sum())",
    ],
)
def test_an_error_is_seen(source):
    assert own_errors(source)
    assert own_errors(f"def f():\n    {source}", {"f"}) == []
