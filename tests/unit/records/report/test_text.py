"""Vectors are written with their axes and units; what only programs read is left out."""

from cellctl.records.report.text import facts


def test_six_components_are_written_with_axes_and_units() -> None:
    document = {"heads_moved_mm_deg": [0.1, -0.2, None, 0.001, 0.0, 2.0]}
    text = "x 0.1 mm, y -0.2 mm, z –, rx 0.001°, ry 0°, rz 2°"
    assert list(facts(document)) == [("heads moved", text)]


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
