"""Dataclasses that hold arrays are compared by identity.

``==`` of two arrays is an array, which has no single answer: a generated ``__eq__`` raises as soon
as it meets one. The sources are read and not imported, because to import all of them takes seconds.
"""

import ast
import contextlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]


@cache
def sources() -> list[ast.Module]:
    """Files with dataclasses or with types made of arrays."""
    texts = [
        path.read_text(encoding="utf-8")
        for package in ("cellctl", "drivers", "fakes")
        for path in (ROOT / package).rglob("*.py")
    ]
    return [ast.parse(text) for text in texts if "@dataclass" in text or "NDArray" in text]


def names_in(node: ast.AST) -> set[str]:
    """Names in an annotation; those inside a quoted one, too."""
    found: set[str] = set()
    for part in ast.walk(node):
        if isinstance(part, ast.Name):
            found.add(part.id)
        elif isinstance(part, ast.Constant) and isinstance(part.value, str):
            with contextlib.suppress(SyntaxError):  # the text of a Literal need not be Python
                found |= names_in(ast.parse(part.value, mode="eval"))
    return found


def array_types() -> set[str]:
    """``NDArray``, ``ndarray`` and all names that stand for a type made of them."""
    aliases = {
        node.targets[0].id: names_in(node.value)
        for tree in sources()
        for node in tree.body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and isinstance(node.value, ast.Subscript)
    }
    known = {"NDArray", "ndarray"}
    while more := {name for name, parts in aliases.items() if parts & known} - known:
        known |= more
    return known


def dataclasses() -> Iterator[tuple[ast.ClassDef, str]]:
    """Every dataclass with the source of its decorator."""
    for tree in sources():
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                for decorator in node.decorator_list:
                    if (text := ast.unparse(decorator)).startswith("dataclass"):
                        yield node, text


def holding_arrays() -> list[tuple[ast.ClassDef, str]]:
    """The dataclasses with arrays, of their own or inherited, with their decorators."""
    arrays = array_types()
    classes = list(dataclasses())
    found: list[tuple[ast.ClassDef, str]] = []
    before = -1
    while len(found) > before:
        before, names = len(found), {node.name for node, _ in found}
        found = [
            (node, decorator)
            for node, decorator in classes
            if any(isinstance(base, ast.Name) and base.id in names for base in node.bases)
            or any(
                names_in(field.annotation) & arrays
                for field in node.body
                if isinstance(field, ast.AnnAssign)
            )
        ]
    return found


def test_no_dataclass_compares_arrays() -> None:
    assert {"Array", "Image"} <= array_types()
    holding = holding_arrays()
    assert len(holding) > 70
    comparing = sorted(node.name for node, text in holding if "eq=False" not in text)
    assert not comparing, "say eq=False: " + ", ".join(comparing)
