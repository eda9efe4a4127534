from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.vision import FeatureFileInvalid
from cellctl.vision.features.feature_file import read_features

GOOD = """
head_1 = ["P1"]
head_2 = ["P2"]
[[hole]]
name = "P1"
kind = "pin"
diameter_mm = 6
position_mm = [-480.0, -180.0, 0.0]
[[hole]]
name = "P2"
kind = "countersink"
diameter_mm = 5.0
countersink_mm = 10.0
position_mm = [1, 2, 3]
"""


def test_features_are_read_in_si(tmp_path: Path) -> None:
    path = tmp_path / "deck.toml"
    path.write_text(GOOD)
    features = read_features(path)
    pin, countersink = features.holes
    assert pin.diameter_m == pytest.approx(6e-3)
    assert pin.countersink_m is None
    assert np.allclose(pin.position_m, [-0.48, -0.18, 0.0])
    assert countersink.countersink_m == pytest.approx(10e-3)
    assert features.seen_by(2) == (countersink,)


def test_the_feature_files_of_the_cell_are_valid() -> None:
    for name in ("frame", "deck"):
        features = read_features(Path(f"config/features/{name}.toml"))
        assert len(features.seen_by(1)) == len(features.seen_by(2)) == 3


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ('kind = "pin"', 'kind = "slot"', "kind"),
        ("diameter_mm = 6", "diameter_mm = -6", "diameter_mm"),
        ("diameter_mm = 6", "diameter = 6", "unknown key diameter"),
        ('name = "P2"', 'name = "P1"', "name of its own"),
        ("[1, 2, 3]", "[1, 2]", "three numbers"),
        ('["P1"]', '["P9"]', "head_1"),
        ("countersink_mm = 10.0", "countersink_mm = 4.0", "exceed"),
        ("[[hole]]", "[[", "not TOML"),
        ("[[hole]]", "thickness_mm = 0.0\n[[hole]]", "thickness_mm"),
    ],
)
def test_what_is_wrong_with_a_file_is_named(tmp_path: Path, old: str, new: str, word: str) -> None:
    path = tmp_path / "deck.toml"
    path.write_text(GOOD.replace(old, new))
    with pytest.raises(FeatureFileInvalid, match=word):
        read_features(path)
