"""Image files that are none, and why."""

from pathlib import Path

import pytest

from cellctl.errors.vision import ImageFileInvalid
from cellctl.vision.camera.image_file import read_unchanged

SAMPLE = Path(__file__).parents[4] / "config" / "samples" / "plate" / "left.png"


def test_a_file_is_read_in_its_own_type() -> None:
    assert read_unchanged(SAMPLE).ndim == 2


@pytest.mark.parametrize("share", [0.001, 0.5, 0.99])
def test_a_png_that_is_cut_off_is_called_so_and_nothing_else_is_printed(
    tmp_path: Path, share: float, capfd: pytest.CaptureFixture[str]
) -> None:
    content = SAMPLE.read_bytes()
    path = tmp_path / "left.png"
    path.write_bytes(content[: max(8, int(share * len(content)))])
    with pytest.raises(ImageFileInvalid, match="is cut off, copy it again"):
        read_unchanged(path)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("content", "words"), [(b"", "is empty"), (b"no image", "not an image, or cut off")]
)
def test_other_files_are_refused(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "left.png"
    path.write_bytes(content)
    with pytest.raises(ImageFileInvalid, match=words):
        read_unchanged(path)
