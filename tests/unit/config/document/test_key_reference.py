"""The reference has every key, none twice, and what the models say of each."""

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest

from cellctl.config.document.key_reference import (
    KeyTable,
    cell_file_tables,
    driver_tables,
    process_tables,
)

CONFIG = Path(__file__).parents[4] / "config"
SHIPPED = sorted(
    path for path in CONFIG.glob("*.toml") if not path.stem.endswith((".scenario", ".model"))
)


@cache
def whose() -> list[tuple[str, KeyTable]]:
    """All tables with the driver or process whose they are."""
    return [*(("", table) for table in cell_file_tables()), *driver_tables(), *process_tables()]


@cache
def tables() -> list[KeyTable]:
    return [table for _, table in whose()]


@cache
def keys() -> set[str]:
    return {key.name for table in tables() for key in table.keys}


def written(node: object) -> Iterator[str]:
    """Every key that a file gives a value to."""
    if isinstance(node, Mapping):
        for name, value in node.items():
            if isinstance(value, Mapping) or (isinstance(value, list) and _tables(value)):
                yield from written(value)
            else:
                yield name
    elif isinstance(node, list):
        for one in node:
            yield from written(one)


def _tables(values: list[object]) -> bool:
    return bool(values) and isinstance(values[0], Mapping)


@pytest.mark.parametrize("file", SHIPPED, ids=lambda path: path.stem)
def test_every_key_of_the_shipped_cells_is_there(file: Path) -> None:
    cell = tomllib.loads(file.read_text(encoding="utf-8"))
    # What stands below these the writer of the file has named.
    for robot in cell["robots"].values():
        robot.pop("poses_deg", None)
    for device in cell.get("digital_ios", {}).values():
        for named in ("inputs", "outputs"):
            device["settings"].pop(named, None)
    chosen = {name for recipe in cell.get("recipes", ()) for name in recipe.pop("roles", {})}
    assert set(written(cell)) - chosen <= keys()


def test_no_table_is_there_twice_and_all_have_words() -> None:
    places = [(of, table.header) for of, table in whose()]
    assert len(set(places)) == len(places)
    assert all(table.about for table in tables())


def test_tables_inside_tables_have_their_place() -> None:
    headers = " ".join(table.header for table in tables())
    for header in (
        "[robots.NAME.load]",
        "[[robots.NAME.ways]]",
        "[zones.NAME.robots.NAME]",
        "[recipes.mating]",
        "[processes.deck-to-frame]",
        "[force_sensors.NAME.stop_channel.settings]",
    ):
        assert header in headers
