"""Writing the files that commands are asked for."""

from pathlib import Path

from cellctl.errors.config import FileInvalid


def write_file(path: Path, content: bytes) -> None:
    """Write a result; raises ``FileInvalid`` with the reason when that cannot be done."""
    try:
        # Not written durably: the command can be repeated, and who waits for it sees whether it
        # failed.
        path.write_bytes(content)
    except OSError as error:
        raise FileInvalid(f"cannot write {path}: {error.strerror or error}") from error
