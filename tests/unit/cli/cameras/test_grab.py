"""`cellctl grab` counts on where an earlier call has ended."""

from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest

grab = import_module("cellctl.cli.cameras.grab")


@pytest.mark.parametrize(
    ("there", "first"),
    [
        ([], 1),
        (["eye-000007.png", "eye-000007.json", "eye-000003-left.png", "eyelid-000099.png"], 8),
        (["eye-999999.png", "eye-1000000-left.png", "eye-1000000.json"], 1_000_001),
    ],
)
def test_nothing_is_overwritten(
    tmp_path: Path, there: list[str], first: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in there:
        (tmp_path / name).touch()
    firsts: list[int] = []

    async def save(_device: object, _folder: Path, number: int, _count: int) -> int:
        firsts.append(number)
        return number

    monkeypatch.setattr(grab, "chosen", lambda *_: SimpleNamespace(name="eye"))
    monkeypatch.setattr(grab, "_save", save)
    grab.grab(tmp_path / "cell.toml", out=tmp_path)
    assert firsts == [first]
