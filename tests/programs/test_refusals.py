"""What a user does wrong before any cell runs: numbered faults, exit codes, no traceback.

The programs end by themselves at once, so these tests run beside others.
"""

import os

import pytest

from tests.rigs.whole_cell.endings import refuses, taken
from tests.rigs.whole_cell.own_cell import OwnCell, cellctl

pytestmark = pytest.mark.timeout(120)


def test_every_error_of_a_cell_file_at_once(own: OwnCell) -> None:
    own.change("d1_mm = 1045.0", "d1_mm = -5.0")
    own.change("max_iterations = 10", "max_iterations = 1000")
    own.change("[robots.main]\n", "[robots.main]\ncolour = 'red'\n")
    own.change('transport = "tcp"', 'transport = "telepathy"')
    checked = cellctl("check", str(own.cell))
    assert checked.returncode == 1
    assert checked.stderr == ""
    for key in ("robots.main.d1_mm", "max_iterations", "robots.main.colour"):
        assert key in checked.stdout
    said = refuses(own.daemon(), "F102", "robots.main.d1_mm", "max_iterations", "colour")
    assert "cellctl check" in said


@pytest.mark.figures  # a program; `tests/unit/config` shows each of them
def test_settings_of_drivers_are_checked_too(own: OwnCell) -> None:
    own.change('transport = "tcp"', 'transport = "telepathy"')
    own.change('driver = "target-server"', 'driver = "crystal-ball"')
    checked = cellctl("check", str(own.cell))
    assert checked.returncode == 1
    assert "force_sensors.force.settings.transport" in checked.stdout
    assert "crystal-ball" in checked.stdout
    assert "target-server" in checked.stdout  # what is installed


def test_cell_file_that_does_not_exist(own: OwnCell) -> None:
    own.cell.unlink()
    refuses(own.daemon(), "F101", "cell.toml")


@pytest.mark.figures  # beside the one that does not exist: both leave by the same way
def test_cell_file_that_is_no_toml(own: OwnCell) -> None:
    own.cell.write_text("name = fake", encoding="utf-8")
    refuses(own.daemon(), "F101", "line 1")


def test_modbus_port_is_taken(own: OwnCell) -> None:
    with taken(own.modbus_port):
        refuses(own.daemon(), "F206", f":{own.modbus_port}")


def test_store_cannot_be_written(own: OwnCell) -> None:
    (own.folder / "a-file").write_text("not a folder", encoding="utf-8")
    refuses(own.daemon(data=own.folder / "a-file" / "store"), "F801", "a-file")


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is forbidden to the superuser")
def test_store_may_not_be_written(own: OwnCell) -> None:
    own.data.mkdir(mode=0o500)
    refuses(own.daemon(), "F801", str(own.data))


@pytest.mark.figures  # beside the taken port: both end before anything starts
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--fault", "head_1:measles"], ["head_1 knows no fault", "no_hole"]),
        pytest.param(
            ["--fault", "nobody:silent"], ["is no device:name", "head_1"], marks=pytest.mark.long
        ),
    ],
)
def test_demonstration_refuses_nonsense(own: OwnCell, options: list[str], words: list[str]) -> None:
    demo = own.demo(own.folder / "run", *options)
    assert demo.end(60) == 2
    demo.nobody_left()
    assert "Traceback" not in demo.stderr
    for word in words:
        assert word in demo.stderr


def test_demonstration_beside_another_one(own: OwnCell) -> None:
    with taken(own.ports[4008]):
        demo = own.demo(own.folder / "run")
        assert demo.end(60) == 1
    demo.nobody_left()
    assert "Traceback" not in demo.stderr
    assert f"{own.ports[4008]}" in demo.stderr
    assert "in use" in demo.stderr


@pytest.mark.long
def test_demonstration_with_a_wrong_cell_file(own: OwnCell) -> None:
    own.change("d1_mm = 1045.0", "d1_mm = -5.0")
    demo = own.demo(own.folder / "run")
    assert demo.end(60) == 1
    demo.nobody_left()
    assert "F102" in demo.stderr
    assert "robots.main.d1_mm" in demo.stderr
    assert "Traceback" not in demo.stderr
