"""Commands work from any folder."""

import subprocess
import sys
from pathlib import Path


def test_the_demonstration_is_found_beside_a_folder_called_cellctl(tmp_path: Path) -> None:
    (tmp_path / "cellctl" / "config").mkdir(parents=True)  # as above a clone
    command = [Path(sys.executable).parent / "cellctl", "demo", "--help"]
    ended = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "--seed" in ended.stdout
