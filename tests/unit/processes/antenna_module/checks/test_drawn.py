"""Forces in the drawings of plug and socket against their contacts, the sensor, each other."""

from pathlib import Path
from shutil import copytree

import pytest

from cellctl.config import problems_before_commissioning
from cellctl.config.commissioning import examine_before_commissioning
from cellctl.config.issue import ConfigIssue

CONFIG = Path(__file__).parents[5] / "config"
PINS, HOLES = "micro-d-15-pins.toml", "micro-d-15-holes.toml"


def found(folder: Path, *files: str, force_n: str, range_n: str = "200.0") -> list[ConfigIssue]:
    """What is wrong with the antenna cell with this ``force_n`` in these drawings."""
    copytree(CONFIG / "connectors", folder / "connectors")
    copytree(CONFIG / "antenna-calibration", folder / "antenna-calibration")
    for name in files:
        path = folder / "connectors" / name
        text = path.read_text(encoding="utf-8")
        assert "force_n = [5.0, 41.7]" in text
        path.write_text(text.replace("[5.0, 41.7]", force_n), encoding="utf-8")
    cell = folder / "antenna.toml"
    text = (CONFIG / "antenna.toml").read_text(encoding="utf-8")
    cell.write_text(
        text.replace("range = [200.0, 200.0, 200.0", f"range = [{range_n}, {range_n}, {range_n}")
    )
    return problems_before_commissioning(cell)


def test_ten_times_the_force_of_such_contacts_is_refused_in_both_drawings(tmp_path: Path) -> None:
    plug, socket = found(tmp_path, PINS, HOLES, force_n="[50.0, 417.0]")
    assert (plug.key, socket.key) == ("recipes.0.plug", "recipes.0.socket")
    assert plug.allowed.startswith("at most 105: greatest force_n of micro-d-15, 7 N for each of")


def test_a_force_that_the_sensor_clips_is_refused(tmp_path: Path) -> None:
    plug, _ = found(tmp_path, PINS, HOLES, force_n="[5.0, 90.0]", range_n="80.0")
    assert plug.allowed.startswith("at most 77.54: greatest force_n of micro-d-15, the range of")


@pytest.mark.parametrize("name", [PINS, HOLES])
def test_a_plug_has_the_force_of_its_socket(tmp_path: Path, name: str) -> None:
    (issue,) = found(tmp_path, name, force_n="[5.0, 60.0]")
    assert issue.key == "recipes.0.plug"
    assert "one connection has one force" in issue.allowed
    assert [one.key for one in issue.against] == ["recipes.0.socket"]


def test_forces_below_every_bound_pass(tmp_path: Path) -> None:
    assert found(tmp_path, PINS, HOLES, force_n="[5.0, 60.0]") == []


@pytest.mark.parametrize(
    ("files", "mm", "said"),
    [
        ((PINS, HOLES), 0.5, {"recipes.0.socket": "up to 0.38 mm beside its middle"}),
        ((HOLES,), 0.3, {"recipes.0.plug": "the socket has capture_mm = 0.3"}),
        ((PINS, HOLES), 0.3, {}),
    ],
)
def test_an_offset_that_no_funnel_takes_is_worth_a_second_look(
    tmp_path: Path, files: tuple[str, ...], mm: float, said: dict[str, str]
) -> None:
    copytree(CONFIG / "connectors", tmp_path / "connectors")
    copytree(CONFIG / "antenna-calibration", tmp_path / "antenna-calibration")
    for name in files:
        path = tmp_path / "connectors" / name
        path.write_text(path.read_text().replace("capture_mm = 0.2", f"capture_mm = {mm}"))
    (tmp_path / "antenna.toml").write_text((CONFIG / "antenna.toml").read_text())
    examined = examine_before_commissioning(tmp_path / "antenna.toml")
    assert examined.errors == ()
    remarks = {one.key: one.allowed for one in examined.remarks}
    assert remarks.keys() == said.keys()
    assert all(words in remarks[key] for key, words in said.items())
