"""Files that are written as a whole or not at all, also when the power fails."""

import os
import tempfile
from contextlib import suppress
from pathlib import Path


def write_durably(path: Path, data: bytes) -> None:
    """Write a file so that after a power cut either the old or the new one is there, whole.

    Returns when the disk has the bytes and the name. Raises ``OSError``.
    """
    make_folder_durably(path.parent)
    # In the same folder: a rename is atomic only within one file system.
    draft = path.with_name(f"{path.name}.part")
    try:
        with draft.open("wb") as file:
            file.write(data)
            file.flush()
            # Before the rename: without it the new name may reach the disk before the bytes, and a
            # power cut leaves an empty file under the good name.
            os.fsync(file.fileno())
        draft.replace(path)
    except OSError:
        # On a full disk every draft that stayed would take room that others need.
        with suppress(OSError):
            draft.unlink()
        raise
    sync_folder(path.parent)


def remove_durably(path: Path) -> None:
    """Remove a file if it is there; raises ``OSError``."""
    if path.exists():
        path.unlink()
        # The name is an entry of the folder, and reaches the disk with it only.
        sync_folder(path.parent)


def make_folder_durably(folder: Path) -> None:
    """Make a folder with those above it, all of them on the disk; raises ``OSError``."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    # A folder is an entry of the one above it: a file in a folder whose own name is not on the disk
    # is lost with it.
    for path in missing:
        sync_folder(path.parent)


def require_writable(folder: Path) -> None:
    """Raise ``OSError`` when no file can be made in a folder, which is made if need be."""
    make_folder_durably(folder)
    with tempfile.TemporaryFile(dir=folder):
        pass  # permissions alone say nothing of a file system that is mounted read-only


def may_write(folder: Path) -> bool:
    """True when this user seems to be allowed to make files in a folder; makes nothing."""
    nearest = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    return os.access(nearest, os.W_OK | os.X_OK)


def sync_folder(folder: Path) -> None:
    """Have the disk store the names in a folder; raises ``OSError``."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
