"""Vectors are written with their axes and units; what only programs read is left out."""

from datetime import UTC, datetime, timedelta

import pytest

from cellctl.records.report.text import duration, facts


def test_six_components_are_written_with_axes_and_units() -> None:
    document = {"heads_moved_mm_deg": [0.1, -0.2, None, 0.001, 0.0, 2.0]}
    text = "x 0.1000 mm, y −0.2000 mm, z –, rx 0.00100°, ry 0.00000°, rz 2.00000°"
    assert list(facts(document)) == [("heads moved", text)]


def test_a_pose_has_the_angles_of_its_written_form() -> None:
    document = {"commanded_mm_deg": [1906.356, 3.3361, 944.6, 90.3469, 0.2547, -179.8468]}
    ((label, text),) = facts(document)
    assert label == "commanded"
    assert text.startswith("X 1906.3560 mm, Y 3.3361 mm, Z 944.6000 mm, A 90.34690°, B 0.25470°")


def test_vectors_have_the_unit_of_their_key() -> None:
    document = {"hold": {"force_n": [1.0, 2.0, 37.5], "moment_n_m": [0.5, 0.0, 0.1]}}
    assert list(facts(document)) == [
        ("hold: force", "1, 2, 37.5 N"),
        ("hold: moment", "0.5, 0, 0.1 N·m"),
    ]


def test_a_list_of_documents_is_numbered_and_deeper_ones_are_left_out() -> None:
    document = {
        "moves": [{"travel_mm": 9.0}, {"travel_mm": 9.5}],
        "covariance_mm2": [[1.0, 0.0], [0.0, 1.0]],
        "images": [{"contacts": [{"name": "1"}]}],
    }
    assert list(facts(document)) == [("moves 1: travel", "9 mm"), ("moves 2: travel", "9.5 mm")]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(119.94, "119.9 s"), (120.0, "2 min 0 s"), (179.6, "3 min 0 s"), (3599.4, "59 min 59 s")],
)
def test_a_minute_has_no_sixty_seconds(seconds: float, text: str) -> None:
    start = datetime(2026, 1, 1, tzinfo=UTC)
    assert duration(start, start + timedelta(seconds=seconds)) == text
