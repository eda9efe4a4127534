"""The text of files that people write: cell files, models, drawings, curves from other programs."""

from pathlib import Path

# UTF-8, and no matter whether the file begins with a byte-order mark: editors and spreadsheets of
# Windows put one before the first character, and TOML and column names would begin with it.
_ENCODING = "utf-8-sig"


def read_hand_written(path: Path) -> str:
    """The text of a file, its lines ended by a line feed; raises ``OSError``, and
    ``UnicodeDecodeError`` for one that is not UTF-8."""
    return path.read_text(encoding=_ENCODING)


def hand_written(content: bytes) -> str:
    """The text of a file's content, its lines ended as they are; raises ``UnicodeDecodeError``."""
    return content.decode(_ENCODING)
