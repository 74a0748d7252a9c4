"""Small breaks of a source: one operator, constant or statement changed, as a slip of the hand would.

Left out is what no test owes an answer to: docstrings, texts, annotations, decorators, words of errors.
"""

import ast
from typing import NamedTuple

COMPARE = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.GtE),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
ARITHMETIC = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.FloorDiv: ast.Mod,
    ast.Mod: ast.FloorDiv,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
PAIRS = (
    "min max",
    "minimum maximum",
    "argmin argmax",
    "floor ceil",
    "any all",
    "sin cos",
    "zeros ones",
    "fmin fmax",
    "sqrt abs",
)
NAMES = {a: b for pair in PAIRS for a, b in (pair.split(), pair.split()[::-1])}
SILENT = {"__repr__", "__str__"}
SAYS = {"warn", "print", "said", "say"}


class Mutant(NamedTuple):
    """One break: where in the text, what stands there and what instead."""

    line: int
    start: int
    end: int
    kind: str
    before: str
    after: str

    def apply(self, text):
        """The broken source."""
        return text[: self.start] + self.after + text[self.end :]

    def words(self):
        """Both sides in one line."""
        return " ".join(self.before.split()), " ".join(self.after.split())


def mutants(text):
    """All breaks of a source, in the order of their places: for each place a list of what it may become."""
    tree, lines = ast.parse(text), text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))

    def offset(line, column):
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())

    places = {}
    for node, kind, after in _walk(tree):
        start, end = offset(node.lineno, node.col_offset), offset(node.end_lineno, node.end_col_offset)
        found = Mutant(node.lineno, start, end, kind, text[start:end], after)
        places.setdefault((start, end, kind), []).append(found)
    return [places[key] for key in sorted(places)]


def _walk(node):
    """Breaks of a node and of all below it that counts: (node to replace, kind, new source)."""
    yield from _breaks(node)
    for child in _children(node):
        yield from _walk(child)


def _children(node):
    """Nodes below that a test should see changed."""
    if isinstance(node, (ast.Raise, ast.Assert, ast.JoinedStr, ast.AnnAssign)):
        return [node.value] if isinstance(node, ast.AnnAssign) and node.value else []
    if isinstance(node, ast.FunctionDef):
        if node.name in SILENT:
            return []
        return [*node.args.defaults, *filter(None, node.args.kw_defaults), *node.body]
    if isinstance(node, ast.ClassDef):
        return node.body
    if isinstance(node, ast.Call) and _called(node) in SAYS:
        return []
    return ast.iter_child_nodes(node)


def _called(node):
    return getattr(node.func, "attr", getattr(node.func, "id", ""))


def _new(node, **changes):
    """Source of a node with other fields, in parentheses."""
    fields = {name: getattr(node, name) for name in node._fields}
    return f"({ast.unparse(type(node)(**{**fields, **changes}))})"


def _text(node):
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _breaks(node):
    """Breaks of this node alone."""
    if isinstance(node, ast.Compare):
        for k, operator in enumerate(node.ops):
            for other in COMPARE[type(operator)]:
                yield node, "compare", _new(node, ops=[*node.ops[:k], other(), *node.ops[k + 1 :]])
    elif isinstance(node, ast.BoolOp):
        yield node, "and-or", _new(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
    elif isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC and not (_text(node.left) or _text(node.right)):
        yield node, "arithmetic", _new(node, op=ARITHMETIC[type(node.op)]())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub, ast.Invert)):
        yield node, "dropped sign or not", f"({ast.unparse(node.operand)})"
    elif isinstance(node, ast.Constant):
        yield from ((node, "constant", after) for after in _constants(node.value))
    elif isinstance(node, ast.Call):
        yield from _calls(node)
    elif isinstance(node, ast.stmt):
        yield from _statements(node)


def _constants(value):
    if isinstance(value, bool):
        return [repr(not value)]
    if isinstance(value, int):
        return [repr(value + 1), repr(value - 1)] if value > 0 else ["1"]
    if isinstance(value, float):
        return [repr(2 * value), repr(value / 2)] if value else ["1.0"]
    return []


def _calls(node):
    name = _called(node)
    if name in NAMES:
        function = ast.Name(NAMES[name]) if isinstance(node.func, ast.Name) else None
        yield node, "other function", _new(node, func=function or ast.Attribute(node.func.value, NAMES[name]))
    if name in ("range", "prange") and not isinstance(node.args[-1], ast.Constant):
        last = 1 if len(node.args) > 1 else 0
        fewer = ast.BinOp(node.args[last], ast.Sub(), ast.Constant(1))
        yield node, "off by one", _new(node, args=[*node.args[:last], fewer, *node.args[last + 1 :]])


def _statements(node):
    """Statements left out, where what follows still runs; and += for -=."""
    if isinstance(node, ast.AugAssign) and type(node.op) in ARITHMETIC:
        yield node, "arithmetic", _new(node, op=ARITHMETIC[type(node.op)]())[1:-1]
    stored = isinstance(node, ast.Assign) and all(
        isinstance(each, (ast.Subscript, ast.Attribute)) for each in node.targets
    )
    called = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and _called(node.value) not in SAYS
    if stored or called or isinstance(node, (ast.AugAssign, ast.Raise, ast.Continue, ast.Break)):
        yield node, "dropped statement", "pass"
