"""Reads a drawing from TOML into its model, with words for every mistake."""

import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from cellctl.calibration.input_file import error_words
from cellctl.errors.base import CellError
from cellctl.files.hand_written import hand_written
from cellctl.sealed_json import content_id

PositiveMm = Annotated[float, Field(gt=0, le=1000)]
Coordinate = Annotated[float, Field(ge=-1000, le=1000)]
PositionMm = tuple[Coordinate, Coordinate]
"""x and y in the drawing's frame."""
Name = Annotated[str, Field(min_length=1, max_length=64)]


class Table(BaseModel):
    """A table of a drawing. A misspelt key is a mistake, not something to be ignored."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, strict=True)

    def id_of(self, keys: frozenset[str]) -> str:
        """SHA-256 of these keys, whatever else the file says and how it is laid out."""
        return content_id(self.model_dump(mode="json", include=set(keys)))


M = TypeVar("M", bound=Table)


def parse_toml(content: bytes, name: str, model: type[M], invalid: type[CellError]) -> M:
    """The content of a file of that name; raises ``invalid`` with everything that is wrong."""
    try:
        return cast(M, _understood(content, model))
    except ValidationError as error:
        raise invalid(f"{name}: {error_words(error)}") from error
    except (ValueError, RecursionError) as error:
        raise invalid(f"{name} is not TOML: {error}") from error


@lru_cache(maxsize=32)
def _understood(content: bytes, model: type[Table]) -> Table:
    # A check of a cell asks for its drawings some ten times, and to compare a pattern with its
    # mirror image takes most of the time.
    return model.model_validate(as_tuples(tomllib.loads(hand_written(content))))


def read_bytes(path: Path, invalid: type[CellError]) -> bytes:
    """A file's content; raises ``invalid`` with the reason."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise invalid(f"{path}: {error.strerror or error}") from error


def as_tuples(value: Any) -> Any:
    """Lists as tuples, which strict models ask for: TOML knows lists alone."""
    if isinstance(value, dict):
        return {key: as_tuples(item) for key, item in value.items()}
    if isinstance(value, list):
        return tuple(as_tuples(item) for item in value)
    return value
