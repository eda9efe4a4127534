"""What is written durably is on the disk with every folder above it."""

from pathlib import Path

import pytest

from cellctl.files import atomic_files
from cellctl.files.atomic_files import make_folder_durably, write_durably


@pytest.fixture
def synced(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Folders whose entries were brought to the disk, in their order."""
    folders: list[Path] = []
    monkeypatch.setattr(atomic_files, "sync_folder", folders.append)
    return folders


def test_each_new_folder_is_an_entry_that_is_brought_to_the_disk(
    tmp_path: Path, synced: list[Path]
) -> None:
    make_folder_durably(tmp_path / "store" / "files" / "ab")
    assert set(synced) == {tmp_path, tmp_path / "store", tmp_path / "store" / "files"}


def test_a_folder_that_was_there_is_left_alone(tmp_path: Path, synced: list[Path]) -> None:
    make_folder_durably(tmp_path)
    assert synced == []


def test_a_file_comes_after_its_folders(tmp_path: Path, synced: list[Path]) -> None:
    path = tmp_path / "files" / "ab" / "name"
    write_durably(path, b"data")
    assert synced[-1] == path.parent
    assert set(synced) == {tmp_path, tmp_path / "files", path.parent}
    assert path.read_bytes() == b"data"


def test_a_draft_for_which_there_is_no_room_does_not_stay(tmp_path: Path) -> None:
    path = tmp_path / "record.json"
    write_durably(path, b"old")
    draft = tmp_path / "record.json.part"
    draft.symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left"):
        write_durably(path, b"new")
    assert not draft.is_symlink()
    assert path.read_bytes() == b"old"
