"""Every message about one key says what has to be written there."""

from pathlib import Path

import pytest

from cellctl.config import problems_before_commissioning
from cellctl.config.issue import ConfigIssue
from tests.unit.config.test_mistakes import CONFIG, written


def _found(folder: Path, old: str, new: str, name: str = "deck.toml") -> ConfigIssue:
    return problems_before_commissioning(written(folder, name, old, new))[0]


@pytest.mark.parametrize(
    ("old", "new", "key", "allowed"),
    [
        (
            "dh = [[0.0, 1045.0, 500.0, -90.0]",
            "dh = [[0.0, 1045.0, 500.0]",
            "robots.main.settings.dh.0",
            "4 numbers; here are 3",
        ),
        (
            "home = [0.0, -90.0, 90.0, 0.0, 90.0, 90.0]",
            "home = [0.0, -90.0, 90.0, 0.0]",
            "robots.main.poses_deg.home",
            "6 numbers; here are 4",
        ),
        (
            "port = 5020",
            'port = "5020"',
            "plc.port",
            "a whole number (an integer), without quotes and point (allowed: 0 to 65535)",
        ),
        (
            'robot_name = "SR500A"',
            "robot_name = 500",
            "robots.main.settings.robot_name",
            'a text, in quotes: "500"',
        ),
        ("port = 5020", "port = 70000", "plc.port", "0 to 65535"),
        (
            "simulated = true",
            'simulated = "true"',
            "robots.main.simulated",
            "true or false, without quotes (a boolean)",
        ),
        (
            'mounted_on = "main"',
            "",
            "force_sensors.force.mounted_on",
            "needed here: a text, in quotes",
        ),
    ],
)
def test_what_to_write_is_a_sentence(
    tmp_path: Path, old: str, new: str, key: str, allowed: str
) -> None:
    found = _found(tmp_path, old, new)
    assert (found.key, found.allowed) == (key, allowed)
    assert found.line is not None


def test_the_mark_that_windows_puts_before_a_file_is_no_mistake(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml")
    drawing = tmp_path / "features" / "deck.toml"
    for file in (path, drawing):
        file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert problems_before_commissioning(path) == []
    assert (CONFIG / "deck.toml").read_bytes()[:3] != b"\xef\xbb\xbf"


def test_a_hole_that_a_list_misspells_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", 'head_1 = ["', 'head_1 = ["X', ("deck.toml",))
    (found,) = problems_before_commissioning(path)
    assert "'XP1' is none of P1, " in found.allowed


def test_a_contact_that_a_drawing_lacks_is_named_with_its_file(tmp_path: Path) -> None:
    path = written(tmp_path, "antenna.toml")
    drawn = next(line for line in path.read_text().splitlines() if line.startswith("plug = "))
    file = tmp_path / drawn.split('"')[1]
    text = file.read_text()
    copied = tmp_path / "plug.toml"
    copied.write_text(text.replace('name = "15"', 'name = "16"'))
    path.write_text(path.read_text().replace(drawn, 'plug = "plug.toml"'))
    found = problems_before_commissioning(path)[0]
    assert "plug.toml (pins) lacks 15" in found.value
    assert "(holes) lacks 16" in found.value
