"""A demonstration that calibrates shows what each procedure has stored."""

import json
from pathlib import Path
from shutil import copytree

import pytest
from rich.console import Console

from fakes.demo.stored_results import StoredResults

SHIPPED = Path(__file__).parents[4] / "config" / "demo-calibration"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(copytree(SHIPPED, tmp_path / "calibration"))


def shown(results: StoredResults) -> str:
    console = Console(width=200)
    with console.capture() as capture:
        for table in results.new():
            console.print(table)
    return capture.get()


def test_only_what_is_new_is_shown(folder: Path) -> None:
    results = StoredResults(folder)
    assert shown(results) == ""
    path = folder / "payload.json"
    content = json.loads(path.read_text())
    content["record"]["checks"][0]["passed"] = False
    path.write_text(json.dumps(content))
    text = shown(results)
    assert content["record"]["checks"][0]["name"] in text
    assert "beyond" in text
    assert "head_1" not in text
    assert shown(results) == ""


def test_every_kind_of_calibration_is_shown(tmp_path: Path) -> None:
    results = StoredResults(tmp_path / "none-yet")
    copytree(SHIPPED, tmp_path / "none-yet")
    text = shown(results)
    for path in SHIPPED.glob("*.json"):
        assert path.stem in text
        for check in json.loads(path.read_text())["record"]["checks"]:
            assert check["name"] in text
