"""Every value of a cell file with the path of its key."""

from collections.abc import Iterator, Mapping
from typing import Any


def leaves(section: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Key and value of all that is no table; ``path`` is the place of the section, with a dot.

    A list of tables counts as tables, with its indices in the path; any other list is a value.
    """
    for name, value in section.items():
        key = f"{path}{name}"
        if isinstance(value, Mapping):
            yield from leaves(value, f"{key}.")
        elif _holds_tables(value):
            for index, one in enumerate(value):
                yield from leaves(one, f"{key}.{index}.")
        else:
            yield key, value


def _holds_tables(value: object) -> bool:
    if not isinstance(value, list | tuple):
        return False
    return bool(value) and all(isinstance(one, Mapping) for one in value)
