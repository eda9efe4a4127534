"""The template of a cell with GigE heads: the general template but for the heads."""

import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from cellctl.config import problems
from drivers.camera.gige.config import GigeHeadConfig

CONFIG = Path(__file__).parents[3] / "config"
TEMPLATE = CONFIG / "deck-gige.toml"
HEADS = "stereo_cameras"


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text())


def test_all_but_the_heads_is_as_in_the_general_template() -> None:
    general, own = read(CONFIG / "cell.toml"), read(TEMPLATE)
    assert general.pop(HEADS) != own.pop(HEADS)
    assert own == general


def test_the_same_values_are_marked_to_be_filled_in() -> None:
    """A mark that is missing leaves a box or a range of the fake cell in the file of a real one."""
    general, own = ((CONFIG / "cell.toml").read_text(), TEMPLATE.read_text())
    assert own.splitlines()[1:] != general.splitlines()
    assert _without_heads(own).splitlines()[1:] == _without_heads(general).splitlines()


def _without_heads(text: str) -> str:
    begin, end = text.index(f"[{HEADS}."), text.index("# A Modbus coupler")
    return text[:begin] + text[end:]


def test_the_heads_are_four_different_cameras() -> None:
    heads = [GigeHeadConfig(**head["settings"]) for head in read(TEMPLATE)[HEADS].values()]
    cameras = [camera.serial_number for head in heads for camera in (head.left, head.right)]
    assert len(set(cameras)) == 4


@pytest.mark.parametrize(
    "key", ["producers", "left.serial_number", "right.serial_number", "flange_T_camera"]
)
def test_what_no_template_can_know_is_marked(key: str) -> None:
    lines = [line for line in TEMPLATE.read_text().splitlines() if line.startswith(f"{key} =")]
    assert len(lines) == 2
    assert all("# FILL IN" in line for line in lines)


def test_checking_it_does_not_load_the_library_of_the_cameras(tmp_path: Path) -> None:
    """harvesters costs start-up time and loads native code: only the cameras' process may."""
    filled_in = tmp_path / "cell.toml"
    filled_in.write_text(TEMPLATE.read_text().replace("FILL IN", "found"))
    (tmp_path / "features").symlink_to(CONFIG / "features")
    program = (
        "import sys\n"
        "from typer.testing import CliRunner\n"
        "from cellctl.cli.commands import whole_app\n"
        f"done = CliRunner().invoke(whole_app(), ['check', {str(filled_in)!r}])\n"
        "assert done.exit_code == 0, done.output\n"
        "assert 'drivers.camera.gige.driver' in sys.modules\n"
        "print(sorted({'harvesters', 'genicam'} & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr


def test_an_exposure_in_microseconds_is_one_error(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATE.read_text().replace("exposure_s = 0.008", "exposure_s = 8000", 1))
    (tmp_path / "features").symlink_to(CONFIG / "features")
    (found,) = problems(path)
    assert found.key.endswith("head_1.settings.exposure_s")
    assert "milliseconds or microseconds" in found.allowed
