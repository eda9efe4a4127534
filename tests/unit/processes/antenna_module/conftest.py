from pathlib import Path
from shutil import copytree

import pytest

CONFIG = Path(__file__).parents[4] / "config"


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    """The shipped cell file with its drawings, to be changed."""
    copytree(CONFIG / "connectors", tmp_path / "connectors")
    made = tmp_path / "antenna.toml"
    made.write_text((CONFIG / "antenna.toml").read_text(encoding="utf-8"), encoding="utf-8")
    return made
