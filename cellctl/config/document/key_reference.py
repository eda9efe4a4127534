"""Every key of a cell file, and those of installed drivers and processes, from their models."""

import ast
import inspect
import json
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from itertools import pairwise
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from cellctl import plugins
from cellctl.config.cell import CellConfig
from cellctl.config.devices import GROUPS
from cellctl.config.document.findings import resolved
from cellctl.config.document.words import entries, limits
from cellctl.config.process_definition import process_definition

_OF_PROCESSES = frozenset({"processes", "recipes"})
"""Keys of the cell file whose tables each process has for itself."""
NEEDED, NONE = "needed", "none"
"""In place of a default: the key must be given; without it there is nothing of the kind."""
_NAME = "NAME"
"""Stands for a name that the writer of the file chooses."""


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a table."""

    name: str
    what: str
    """What may be written there."""
    default: str
    """The default as it would be written, or ``NEEDED``, or ``NONE``."""
    meaning: str
    """The words beside the key in its model; empty where its name says it all."""


@dataclass(frozen=True, slots=True)
class KeyTable:
    """One table of the file."""

    header: str
    """As it stands in the file, such as ``[robots.NAME.load]``; empty for the file's beginning."""
    about: str
    keys: tuple[Key, ...]


def cell_file_tables() -> Iterator[KeyTable]:
    """Those that every cell file may have."""
    yield from _tables(CellConfig, "", left_out=_OF_PROCESSES)


def driver_tables() -> Iterator[tuple[str, KeyTable]]:
    """The kind and name of each installed driver, with a table of its settings; raises
    ``UnknownDriver`` for one that cannot be loaded."""
    kinds = {group: section for section, group in GROUPS.items()}
    kinds[plugins.STOP_CHANNEL] = f"force_sensors.{_NAME}.stop_channel"
    for group, section in kinds.items():
        place = section if group == plugins.STOP_CHANNEL else f"{section}.{_NAME}"
        for name in plugins.names(group):
            driver: Any = plugins.load(group, name)
            for table in _tables(driver.Config, f"{place}.settings"):
                yield f"{group.removeprefix('cellctl.').replace('_', ' ')} `{name}`", table


def process_tables() -> Iterator[tuple[str, KeyTable]]:
    """The name of each installed process, with its tables; raises ``UnknownDriver`` for one that
    cannot be loaded."""
    for name in plugins.names(plugins.PROCESS):
        definition = process_definition(name)
        for table in _tables(definition.settings_model, f"processes.{name}"):
            yield name, table
        for table in _tables(definition.recipe_model, "recipes", listed=True):
            yield name, table


def _tables(
    model: type[BaseModel],
    path: str,
    *,
    listed: bool = False,
    left_out: frozenset[str] = frozenset(),
) -> Iterator[KeyTable]:
    """The table of a model, then those inside it. ``listed``: there may be any number of it."""
    schema, meanings = model.model_json_schema(), _meanings(model)
    header = f"[[{path}]]" if listed else f"[{path}]" if path else ""
    inside, keys = [], []
    for name, field in model.model_fields.items():
        if name in left_out:
            continue
        inner = _inner(field.annotation)
        if inner is None:
            node = resolved(schema["properties"][name], schema)
            keys.append(Key(name, _what(node), _default(field), meanings.get(name, "")))
        else:
            inside.append((name, *inner))
    if keys:
        yield KeyTable(header, _about(model), tuple(keys))
    for name, below, among, nested in inside:
        deeper = ".".join(part for part in (path, name, below) if part)
        yield from _tables(nested, deeper, listed=among)


def _inner(annotation: Any) -> tuple[str, bool, type[BaseModel]] | None:
    """What a key holds when it is a table: its name below the key, whether it is one of a list, and
    its model."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _inner(arguments[0])
    if origin in (Union, UnionType):
        known = [one for one in arguments if one is not NoneType]
        return _inner(known[0]) if len(known) == 1 else None
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return "", False, annotation
    if origin is dict and (found := _inner(arguments[1])) is not None:
        return _NAME, False, found[2]
    if origin is tuple and len(arguments) == 2 and arguments[1] is Ellipsis:
        found = _inner(arguments[0])
        return None if found is None else ("", True, found[2])
    return None


def _what(node: Mapping[str, Any]) -> str:
    """What may be written, in few words: an error message has more of them."""
    kind = str(node.get("type"))
    if "const" in node:
        return json.dumps(node["const"])
    if "enum" in node:
        return " or ".join(json.dumps(one) for one in node["enum"])
    if kind == "array":
        return entries(node, None).removeprefix("a list in [ ] with ")
    if kind == "string" and "examples" in node:
        return f"text such as {json.dumps(node['examples'][0])}"
    plain = _PLAIN.get(kind, "value")
    return f"{plain}, {allowed}" if (allowed := limits(node)) else plain


_PLAIN = {
    "string": "text",
    "boolean": "true or false",
    "integer": "whole number",
    "number": "number",
    "object": "table",
}


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return NEEDED
    value = field.get_default(call_default_factory=True)
    return NONE if value is None else _written(value)


def _written(value: Any) -> str:
    if isinstance(value, Enum):
        return _written(value.value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(_written(one) for one in value)}]"
    return json.dumps(value, default=str, ensure_ascii=False)


def _about(model: type[BaseModel]) -> str:
    return _on_one_line(inspect.getdoc(model) or "")


@cache
def _meanings(model: type[BaseModel]) -> Mapping[str, str]:
    """The text below each key in the source of its model: pydantic would read it at every start of
    every program."""
    found: dict[str, str] = {}
    for kind in reversed(model.__mro__):
        if not issubclass(kind, BaseModel) or kind is BaseModel:
            continue
        try:
            source = textwrap.dedent(inspect.getsource(kind))
        except OSError:
            continue  # a package without its sources: its keys are listed without words
        (definition,) = ast.parse(source).body
        assert isinstance(definition, ast.ClassDef)
        for statement, following in pairwise(definition.body):
            match statement, following:
                case (
                    ast.AnnAssign(target=ast.Name(id=name)),
                    ast.Expr(value=ast.Constant(value=str(text))),
                ):
                    found[name] = _on_one_line(text)
    return found


def _on_one_line(text: str) -> str:
    return " ".join(text.split())
