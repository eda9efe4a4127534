"""Files of insertion curves, good and broken."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.processes.antenna_module.faults.plugging import InsertionCurveInvalid
from cellctl.processes.antenna_module.insertion.curve import parse_curve
from tests.rigs.antenna.curves import as_csv, curve

TEXT = as_csv(curve())
LINES = TEXT.splitlines()


def test_a_file_is_read_back() -> None:
    again, first = parse_curve(TEXT), curve()
    np.testing.assert_allclose(again.depth_m, first.depth_m, atol=1e-9)
    np.testing.assert_allclose(again.force_n, first.force_n, atol=1e-6)
    assert len(list(again)) == len(first.t_s)


def test_columns_may_be_called_as_those_of_a_peg_by_touch() -> None:
    other = TEXT.replace("t_s", "time_s", 1).replace("_n_m", "_nm")
    np.testing.assert_array_equal(parse_curve(other).moment_n_m, parse_curve(TEXT).moment_n_m)
    np.testing.assert_array_equal(parse_curve(other).t_s, parse_curve(TEXT).t_s)
    twice = "\n".join([f"{LINES[0]},time_s", *(f"{line},x" for line in LINES[1:])])
    np.testing.assert_array_equal(parse_curve(twice).t_s, parse_curve(TEXT).t_s)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "missing column"),
        (TEXT.replace("fz_n", "fz"), "missing column fz_n$"),
        (TEXT.replace(",", ";"), "missing column t_s.* separated by semicolons; expected commas"),
        (TEXT.replace(",", "\t"), "missing column t_s.* separated by tabs; expected commas"),
        ("\n".join(LINES[:10]), "9 samples"),
        ("\n".join([*LINES[:30], "1,2,3,x,5,6,7,8", *LINES[31:]]), "line 31: fy_n is 'x'"),
        ("\n".join([*LINES[:30], "1,2,3", *LINES[31:]]), "line 31: fy_n"),
        ("\n".join([*LINES[:30], "1,2,nan,4,5,6,7,8", *LINES[31:]]), "line 31: fx_n"),
        ("\n".join([*LINES[:30], LINES[20], *LINES[31:]]), "time does not rise"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(text: str, word: str) -> None:
    with pytest.raises(InsertionCurveInvalid, match=word):
        parse_curve(text)


@given(
    st.one_of(
        st.text(max_size=300),
        st.builds(
            lambda at, junk: TEXT[:at] + junk + TEXT[at + len(junk) :],
            st.integers(0, len(TEXT)),
            st.text(max_size=20),
        ),
    )
)
def test_any_text_is_read_or_refused_by_name(text: str) -> None:
    try:
        curve_read = parse_curve(text)
    except InsertionCurveInvalid:
        return
    assert np.isfinite(curve_read.force_n).all()
