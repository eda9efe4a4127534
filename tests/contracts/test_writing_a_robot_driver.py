"""docs/writing-a-robot-driver.md is true: the package that it describes passes both contracts, and
this repository's own tests pass beside it.
"""

from pathlib import Path

from tests.guides.package import (
    ROOT,
    contract_of,
    guide_package,
    registry_beside,
    style_of,
    write_files,
)

GUIDE = ROOT / "docs" / "writing-a-robot-driver.md"
FOLDER = {"README.md", "config.py", "protocol.py", "connection.py", "driver.py", "faults.py"}


written, installed = guide_package(GUIDE, "cellctl-beta")


def test_the_folder_is_complete(written: Path) -> None:
    assert {path.name for path in (written / "beta_r6").iterdir()} >= FOLDER


def test_both_contracts_hold(written: Path, installed: Path) -> None:
    done = contract_of(written, installed)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "23 passed" in done.stdout


def test_a_driver_that_forgets_a_duty_does_not_pass(tmp_path: Path) -> None:
    """The contract finds what the page warns of: a bound and a stop that are missing."""
    write_files(GUIDE, tmp_path)
    driver = tmp_path / "beta_r6" / "driver.py"
    text = driver.read_text(encoding="utf-8")
    for duty in (
        "        self._bounds.step(self.state(), base_T_flange)\n",
        "            await self.stop()\n            raise\n",
    ):
        assert duty in text
        text = text.replace(duty, "            raise\n" if "raise" in duty else "")
    driver.write_text(text, encoding="utf-8")
    done = contract_of(tmp_path, tmp_path)
    assert done.returncode == 1
    for clause in ("test_targets_are_bounded", "test_cancellation_stops_first"):
        assert f"::{clause}" in done.stdout, done.stdout


def test_our_own_tests_pass_beside_it(installed: Path) -> None:
    done = registry_beside(installed)
    assert done.returncode == 0, done.stdout + done.stderr
    for group in ("cellctl.robot", "cellctl.stop_channel"):
        assert f"test_implements_its_interface[{group}:beta-r6] PASSED" in done.stdout


def test_the_code_has_the_style_of_the_house(written: Path) -> None:
    for done in style_of(written):
        assert done.returncode == 0, done.stdout + done.stderr
