"""What is written in a scenario file, before it is held to the model of its scene."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fakes.imperfections import check_scales, scale_written


def read_written(path: Path, imperfections: Mapping[str, float]) -> dict[str, Any]:
    """The sections of a scenario file, with those of the file that it is ``like``.

    Sizes of imperfections are scaled already. Raises ``OSError``, ``tomllib.TOMLDecodeError`` or
    ``fakes.imperfections.UnknownImperfection``.
    """
    with path.open("rb") as file:
        written = tomllib.load(file)
    if like := written.pop("like", None):
        # One other file and no more: a chain of files could not be read by a person.
        with (path.parent / str(like)).open("rb") as file:
            written = _merged(tomllib.load(file), written)
    scales = {**written.get("imperfections", {}), **imperfections}
    check_scales(scales)
    return scale_written({**written, "imperfections": scales}, scales)


def _merged(below: Mapping[str, Any], above: Mapping[str, Any], depth: int = 2) -> dict[str, Any]:
    """Sections and devices are joined key by key; of what a device says the upper one counts."""
    both = {
        key: _merged(below[key], value, depth - 1)
        for key, value in above.items()
        if depth and isinstance(value, dict) and isinstance(below.get(key), dict)
    }
    return {**below, **above, **both}
