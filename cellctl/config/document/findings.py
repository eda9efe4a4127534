"""What a model of pydantic has against a section, in the words of whoever wrote the file."""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from cellctl.config.issue import ConfigIssue
from cellctl.spelling import nearest

Model = TypeVar("Model", bound=BaseModel)

_LONGEST_VALUE = 60
_MOST_KEYS = 12


def validated(model: type[Model], raw: object) -> Model:
    """The section as its model; raises pydantic's ``ValidationError``.

    Strict: a number in quotes is no number, and 1 is not true. As JSON, because a list of TOML is a
    tuple of the model only there; a date, which no key has, becomes text.
    """
    return model.model_validate_json(json.dumps(raw, default=str), strict=True)


def model_issues(
    prefix: str, error: ValidationError, model: type[BaseModel], raw: object
) -> list[ConfigIssue]:
    """One finding for each thing that is wrong; ``prefix`` is the path of the section with a dot.

    ``raw`` is the section as it was written.
    """
    found = []
    items = error.errors(include_url=False)
    schema = model.model_json_schema()
    # pydantic calls a list with one bad entry "too short", in addition to what is wrong with the
    # entry. That would send the user to look for a missing one.
    parents = {item["loc"][:depth] for item in items for depth in range(1, len(item["loc"]))}
    for item in items:
        loc = item["loc"]
        if item["type"] == "too_short" and loc in parents:
            continue  # it has entries; what is wrong with them is reported by itself
        key = prefix + ".".join(str(part) for part in loc if part != "[key]")
        missing = item["type"] == "missing"
        value = "(missing)" if missing else shorten(repr(_at(raw, loc, item["input"])))
        key = key.rstrip(".")
        if item["type"] == "extra_forbidden":
            allowed = _other_key(str(loc[-1]), _node(schema, loc[:-1]))
        elif item["type"] == "value_error":
            allowed = str(item["ctx"]["error"])
            inside, value = _named_in(allowed, _at(raw, loc, item["input"]), value)
            key = f"{key}.{inside}" if key and inside else inside or key
        else:
            of_keys = loc[-1:] == ("[key]",)
            node = (
                _node(schema, loc[:-2]).get("propertyNames", {}) if of_keys else _node(schema, loc)
            )
            allowed = _words(item, node)
        found.append(ConfigIssue(key or "(file)", value, allowed))
    return found


def shorten(text: str) -> str:
    """A value that fits a line."""
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"


def _named_in(message: str, section: object, shown: str) -> tuple[str, str]:
    """Of a table, the keys that a message speaks of: the first of them, and all with their values.

    Else nothing, and ``shown``.
    """
    if not isinstance(section, Mapping):
        return "", shown
    named = [word for word in re.findall(r"\w+", message) if word in section]
    if not named:
        return "", shown
    first, *others = dict.fromkeys(named)
    also = "".join(f", {name} = {section[name]!r}" for name in others)
    return first, shorten(f"{section[first]!r}{also}")


def _words(item: ErrorDetails, node: Mapping[str, Any]) -> str:
    """pydantic's message, or better words where it speaks of patterns, objects and tuples."""
    kind = item["type"]
    if kind == "string_pattern_mismatch":
        return _of_the_form(str(item["input"]), item["ctx"]["pattern"], node.get("examples", ()))
    if kind == "too_long":
        length, most = item["ctx"]["actual_length"], item["ctx"]["max_length"]
        comma = "; a number has a decimal point, no comma" if length == 2 * most else ""
        return f"at most {most} entries, these are {length}{comma}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        keys = ", ".join(f"{key} = …" for key in node.get("properties", {})) or "name = …"
        return f"a table: {{ {keys} }}"
    return item["msg"] + _bounds(node)


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


def _other_key(name: str, node: Mapping[str, Any]) -> str:
    keys = sorted(node.get("properties", {}))
    listed = ", ".join(keys[:_MOST_KEYS]) + (", …" if len(keys) > _MOST_KEYS else "")
    return f"no such key; {nearest(name, keys)}keys here: {listed or 'none'}"


def _at(raw: object, loc: tuple[int | str, ...], otherwise: object) -> object:
    """The value as it was written: pydantic names the inputs of a whole section, too."""
    for part in loc:
        try:
            raw = raw[part]  # type: ignore[index]
        except (KeyError, IndexError, TypeError):
            return otherwise
    return raw


def _node(schema: Mapping[str, Any], loc: tuple[int | str, ...]) -> Mapping[str, Any]:
    """The part of a JSON schema that describes a place; empty where it says nothing of it."""
    node = _resolved(schema, schema)
    for part in loc:
        if isinstance(part, int):
            items = node.get("prefixItems", [])
            child = items[part] if part < len(items) else node.get("items", {})
        else:
            child = node.get("properties", {}).get(part, node.get("additionalProperties", {}))
            if not child and "patternProperties" in node:
                child = next(iter(node["patternProperties"].values()))
        node = _resolved(child if isinstance(child, Mapping) else {}, schema)
    return node


def _resolved(node: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    """The node itself instead of a reference to it; of "this or nothing", this."""
    while True:
        if "$ref" in node:
            node = schema["$defs"][str(node["$ref"]).rsplit("/", 1)[-1]]
        elif len(options := _options(node)) == 1:
            node = options[0]
        else:
            return node


def _options(node: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [option for option in node.get("anyOf", []) if option.get("type") != "null"]


def _bounds(node: Mapping[str, Any]) -> str:
    """Both limits of a number: pydantic names the one that was passed only."""
    lower = node.get("minimum", node.get("exclusiveMinimum"))
    upper = node.get("maximum", node.get("exclusiveMaximum"))
    if lower is None or upper is None:
        return ""
    above = "more than " if "exclusiveMinimum" in node else ""
    below = "less than " if "exclusiveMaximum" in node else ""
    return f" (allowed: {above}{lower:g} to {below}{upper:g})"
