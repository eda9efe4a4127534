"""Values of the cell file that its own sections refuse."""

from pathlib import Path

import pytest

from cellctl.config import problems
from tests.unit.config.test_mistakes import written


@pytest.mark.parametrize(
    ("path", "good"), [("s" * 107, True), ("s" * 108, False), ("é" * 54, False)]
)
def test_a_socket_that_no_daemon_can_open_is_refused(
    tmp_path: Path, path: str, *, good: bool
) -> None:
    """The kernel counts bytes, and a daemon would find out at its start."""
    cell_file = written(tmp_path / "cell", "deck.toml")
    text = cell_file.read_text(encoding="utf-8")
    cell_file.write_text(f'{text}\n[local_api]\nsocket = "{path}"\n', encoding="utf-8")
    found = problems(cell_file)
    assert [(one.key, one.allowed) for one in found] == (
        [] if good else [("local_api.socket", "a path of at most 107 bytes; this one has 108")]
    )
