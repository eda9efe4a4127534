"""The reference has every key, none twice, and what the models say of each."""

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from cellctl.config.key_reference import cell_file_tables, driver_tables, process_tables

CONFIG = Path(__file__).parents[3] / "config"
SHIPPED = sorted(
    path for path in CONFIG.glob("*.toml") if not path.stem.endswith((".scenario", ".model"))
)
WHOSE = [*(("", table) for table in cell_file_tables()), *driver_tables(), *process_tables()]
TABLES = [table for _, table in WHOSE]
KEYS = {key.name for table in TABLES for key in table.keys}
HEADERS = " ".join(table.header for table in TABLES)


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
    assert set(written(cell)) - chosen <= KEYS


def test_no_table_is_there_twice_and_all_have_words() -> None:
    places = [(whose, table.header) for whose, table in WHOSE]
    assert len(set(places)) == len(places)
    assert all(table.about for table in TABLES)


def test_tables_inside_tables_have_their_place() -> None:
    for header in (
        "[robots.NAME.load]",
        "[[robots.NAME.ways]]",
        "[zones.NAME.robots.NAME]",
        "[recipes.mating]",
        "[processes.deck-to-frame]",
        "[force_sensors.NAME.stop_channel.settings]",
    ):
        assert header in HEADERS
