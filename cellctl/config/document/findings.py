"""What a model of pydantic has against a section, in the words of whoever wrote the file."""

import json
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

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
        if item["type"] == "extra_forbidden":
            allowed = _other_key(str(loc[-1]), _node(schema, loc[:-1]))
        else:
            allowed = item["msg"] + _bounds(_node(schema, loc))
        found.append(ConfigIssue(key.rstrip(".") or "(file)", value, allowed))
    return found


def shorten(text: str) -> str:
    """A value that fits a line."""
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"


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
