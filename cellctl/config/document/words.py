"""What has to be written at a key that a model refuses, in sentences."""

import re
from collections.abc import Callable, Mapping, Sequence, Sized
from typing import Any

from pydantic_core import ErrorDetails

_TEXT = "a text, in quotes"
_BOOLEAN = "true or false, without quotes (a boolean)"
_INTEGER = "a whole number (an integer), without quotes and point"
_NUMBER = "a number, without quotes"


def words(item: ErrorDetails, node: Mapping[str, Any]) -> str:
    """What belongs at the place of an error of pydantic; ``node`` is its part of the schema.

    The message of pydantic where there are no better words.
    """
    better = _WORDS.get(item["type"])
    found = "" if better is None else better(item, node)
    return found or item["msg"] + _allowed(node)


def _form(item: ErrorDetails, node: Mapping[str, Any]) -> str:
    return _of_the_form(str(item["input"]), item["ctx"]["pattern"], node.get("examples", ()))


def _missing(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    return f"needed here: {_what(node)}"


def _figure(item: ErrorDetails, node: Mapping[str, Any]) -> str:
    whole = item["type"].startswith("int")
    return (_INTEGER if whole else _NUMBER) + _allowed(node)


def _text(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    written = item["input"]
    plain = isinstance(written, int | float) and not isinstance(written, bool)
    return f'{_TEXT}: "{written}"' if plain else _TEXT


def _boolean(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    return _BOOLEAN


def _bounds(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    return limits(node)


def _list(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    return entries(node, None)


def _count(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    length, counts = len(item["input"]), item["ctx"]
    if "max_length" in counts:
        most = counts["max_length"]
        comma = "; a number has a decimal point, no comma" if length == 2 * most else ""
        return f"at most {most} entries, these are {length}{comma}"
    return f"at least {counts['min_length']} entries, these are {length}"


def _table(item: ErrorDetails, node: Mapping[str, Any]) -> str:  # noqa: ARG001
    keys = ", ".join(f"{key} = …" for key in node.get("properties", {})) or "name = …"
    return f"a table: {{ {keys} }}"


_WORDS: Mapping[str, Callable[[ErrorDetails, Mapping[str, Any]], str]] = {
    "string_pattern_mismatch": _form,
    "missing": _missing,
    **dict.fromkeys(("int_type", "int_from_float", "int_parsing"), _figure),
    **dict.fromkeys(("float_type", "float_parsing"), _figure),
    "string_type": _text,
    "bool_type": _boolean,
    **dict.fromkeys(
        ("greater_than", "greater_than_equal", "less_than", "less_than_equal"), _bounds
    ),
    **dict.fromkeys(("tuple_type", "list_type"), _list),
    **dict.fromkeys(("too_long", "too_short"), _count),
    **dict.fromkeys(("model_type", "model_attributes_type", "dict_type"), _table),
}


def entries(node: Mapping[str, Any], row: object) -> str:
    """How many entries a list has to have, and how many there are; ``row`` is None for no list."""
    least = node.get("minItems", len(node.get("prefixItems", ())))
    most = node.get("maxItems")
    count = f"{least}" if least == most else f"at least {least}" if least else "any number of"
    first = next(iter(node.get("prefixItems", ())), node.get("items", {}))
    of_what = "numbers" if isinstance(first, Mapping) and _is_number(first) else "entries"
    if isinstance(row, Sized):
        return f"{count} {of_what}; here are {len(row)}"
    return f"a list in [ ] with {count} {of_what}"


def _what(node: Mapping[str, Any]) -> str:
    """What kind of value a place holds."""
    kind = node.get("type")
    if "enum" in node:
        return f"one of {', '.join(repr(one) for one in node['enum'])}"
    if kind == "array":
        return entries(node, None)
    if kind == "object":
        needed = ", ".join(f"{key} = …" for key in node.get("required", ()))
        return f"a table {{ {needed} }}" if needed else "a table"
    plain = _PLAIN.get(str(kind), "a value")
    return f"{plain}{_allowed(node)}"


_PLAIN = {"string": _TEXT, "boolean": _BOOLEAN, "integer": _INTEGER, "number": _NUMBER}


def _is_number(node: Mapping[str, Any]) -> bool:
    return node.get("type") in {"integer", "number"}


def _allowed(node: Mapping[str, Any]) -> str:
    return f" (allowed: {within})" if (within := limits(node)) else ""


def limits(node: Mapping[str, Any]) -> str:
    """Both limits of a number, or the only one: pydantic names the one that was passed."""
    above, below = "exclusiveMinimum" in node, "exclusiveMaximum" in node
    lower = node.get("exclusiveMinimum", node.get("minimum"))
    upper = node.get("exclusiveMaximum", node.get("maximum"))
    if lower is None and upper is None:
        return ""
    if upper is None:
        return f"{'more than' if above else 'at least'} {lower:g}"
    if lower is None:
        return f"{'less than' if below else 'at most'} {upper:g}"
    return f"{'more than ' * above}{lower:g} to {'less than ' * below}{upper:g}"


def _of_the_form(written: str, pattern: str, examples: Sequence[str]) -> str:
    """What is shown in place of a pattern: an example of it, and what was probably meant."""
    simple = re.sub(r"[^A-Za-z0-9]+", "_", written).strip("_")
    slips: tuple[str, ...] = (
        written.lower(),
        written.upper(),
        simple,
        simple.lower(),
        simple.upper(),
    )
    digits = re.fullmatch(r"(\d+)\D+(\d+)\D*", written)
    if digits:
        slips = (*slips, f"{digits[1]}x{digits[2]}")
    meant = next((f"did you mean {one!r}? " for one in slips if re.match(pattern, one)), "")
    form = f"a text of the form {examples[0]!r}" if examples else f"a text that fits {pattern}"
    return f"{meant}{form}"
