"""What the campaign says about the measuring loop."""

from io import StringIO

from rich.console import Console

from benchmarks.campaign import decay, normalised, told

FIRST, SECOND = [0.1, -0.2, 0.3, 0.01, 0.02, -0.03], [0.01, 0.0, -0.02, 0.001, 0.002, 0.003]


def test_each_look_has_its_errors_and_how_many_runs_needed_it() -> None:
    written = StringIO()
    found = decay([{"errors_mm_deg": [FIRST, SECOND]}, {"errors_mm_deg": [SECOND]}])
    Console(file=written, width=200).print(found)
    rows = [line.split() for line in written.getvalue().splitlines() if "│" in line]
    cells = [[cell for cell in row if cell not in {"│", "/"}] for row in rows]
    assert cells[0][:5] == ["1", "2", "1", "0.0550", "0.1000"]
    assert cells[1][:5] == ["2", "1", "1", "0.0100", "0.0100"]


def test_a_bad_part_that_was_called_good_is_told_from_one_that_was_not() -> None:
    assert told({"passed": True, "result": "good"}) == "good"
    assert told({"passed": False, "result": "good"}) == "CALLED GOOD, IS NOT"
    for result in ({"result": "bad"}, {"result": "none"}, {}):
        assert told({"passed": False, **result}) == "not good, and called so"


def test_normalised_errors_are_those_of_the_runs_that_have_some() -> None:
    written = StringIO()
    errors = [[1.0, 0.0, 0.5, 2.0, 0.0, 0.0], [-1.0, 0.0, 0.5, -1.0, 0.0, 0.0], None]
    found = normalised([{"seat_normalised": one} for one in errors])
    Console(file=written, width=200).print(found)
    (row,) = [line.split("│")[1:-1] for line in written.getvalue().splitlines() if "rms" in line]
    assert [cell.strip() for cell in row] == [
        "rms of 2", "1.00", "0.00", "0.50", "1.58", "0.00", "0.00",
    ]  # fmt: skip
