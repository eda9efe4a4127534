"""What a model of pydantic has against a section, in the words of whoever wrote the file."""

import json
import re
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from cellctl.config.document.words import entries, words
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
    short: set[tuple[int | str, ...]] = set()
    for item in items:
        loc = item["loc"]
        if item["type"] == "too_short" and loc in parents:
            continue  # it has entries; what is wrong with them is reported by itself
        key = prefix + ".".join(str(part) for part in loc if part != "[key]")
        if item["type"] == "missing" and isinstance(loc[-1], int):
            # A row that is too short has one mistake, however many of its entries are missing.
            if loc[:-1] in short:
                continue
            short.add(loc[:-1])
            row, node = _at(raw, loc[:-1], ()), _node(schema, loc[:-1])
            key = key.rpartition(".")[0]
            found.append(ConfigIssue(key or "(file)", shorten(repr(row)), entries(node, row)))
            continue
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
            allowed = words(item, node)
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
    node = resolved(schema, schema)
    for part in loc:
        if isinstance(part, int):
            items = node.get("prefixItems", [])
            child = items[part] if part < len(items) else node.get("items", {})
        else:
            child = node.get("properties", {}).get(part, node.get("additionalProperties", {}))
            if not child and "patternProperties" in node:
                child = next(iter(node["patternProperties"].values()))
        node = resolved(child if isinstance(child, Mapping) else {}, schema)
    return node


def resolved(node: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
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
