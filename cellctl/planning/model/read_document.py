"""Reads the keys of a model file, without the libraries that planning needs."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cellctl.config.document.findings import model_issues, validated
from cellctl.config.document.lines import key_lines, line_of
from cellctl.config.issue import ConfigIssue
from cellctl.errors.config import ConfigInvalid, ConfigUnreadable
from cellctl.files.hand_written import read_hand_written
from cellctl.planning.model.document import ModelDocument


def read_document(path: Path) -> ModelDocument:
    """The keys of a model file; raises ``ConfigUnreadable``, ``ConfigInvalid``."""
    text, raw = _read(path)
    try:
        return validated(ModelDocument, raw)
    except ValidationError as error:
        found = "; ".join(str(issue) for issue in _issues(error, text, raw))
        raise ConfigInvalid(f"{path}: {found}") from error


def document_issues(path: Path) -> list[ConfigIssue]:
    """What is wrong with the keys of a model file, for whoever checks the cell file beside it.

    The lines stand with the keys: those of findings are lines of the cell file.
    """
    try:
        text, raw = _read(path)
        validated(ModelDocument, raw)
    except ConfigUnreadable as fault:
        return [ConfigIssue(path.name, "(unreadable)", fault.detail, fault.number)]
    except ValidationError as error:
        return [
            replace(issue, key=f"{path.name}, line {issue.line}: {issue.key}", line=None)
            for issue in _issues(error, text, raw)
        ]
    return []


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    try:
        text = read_hand_written(path)
        return text, tomllib.loads(text)
    except FileNotFoundError as error:
        raise ConfigUnreadable(
            f"{path}: this cell has no model yet. Write one: where its arms stand, their bodies "
            "and what stands around them (docs/planning.md); config/deck.model.toml, "
            "antenna.model.toml and insertion-pin.model.toml show how"
        ) from error
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigUnreadable(f"{path}: {error}") from error


def _issues(error: ValidationError, text: str, raw: dict[str, Any]) -> list[ConfigIssue]:
    lines = key_lines(text)
    return [
        replace(issue, line=line_of(issue.key, lines))
        for issue in model_issues("", error, ModelDocument, raw)
    ]
