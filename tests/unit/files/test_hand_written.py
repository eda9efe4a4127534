"""The text of files that people write."""

from pathlib import Path

import pytest

from cellctl.files.hand_written import hand_written, read_hand_written

TEXT = 'name = "Träger 1"\n'


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path: Path, mark: bytes) -> None:
    content = mark + TEXT.encode()
    (tmp_path / "cell.toml").write_bytes(content)
    assert read_hand_written(tmp_path / "cell.toml") == hand_written(content) == TEXT


def test_lines_of_a_file_end_with_a_line_feed_alone(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_bytes(b"a = 1\r\nb = 2\r\n")
    assert read_hand_written(tmp_path / "cell.toml") == "a = 1\nb = 2\n"


def test_what_is_not_utf_8_is_refused(tmp_path: Path) -> None:
    content = "Träger".encode("latin-1")
    (tmp_path / "cell.toml").write_bytes(content)
    with pytest.raises(UnicodeDecodeError):
        read_hand_written(tmp_path / "cell.toml")
    with pytest.raises(UnicodeDecodeError):
        hand_written(content)
