import numpy as np
import pytest

from cellctl.errors.force import PayloadFileInvalid
from cellctl.force.gravity.pose_file import parse_pose_file
from cellctl.force.gravity.poses import PoseRole
from tests.rigs.payload_world import LoadedSensor, format_pose_file, record

HEADER = "qx,qy,qz,qw,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm"
GOOD = "0,0,0,1,1,2,3,4,5,6"


def test_what_is_written_is_read_back() -> None:
    written = record(LoadedSensor(), np.random.default_rng(1))
    again = parse_pose_file(format_pose_file(written))
    assert again.roles == written.roles
    np.testing.assert_allclose(again.wrenches, written.wrenches, atol=5e-5)
    error = (again.base_R_sensor.inv() * written.base_R_sensor).magnitude()
    np.testing.assert_allclose(error, 0.0, atol=1e-7)


def test_columns_may_come_in_any_order_with_comments_and_a_byte_order_mark() -> None:
    text = "\ufeff# a comment\nfx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,qw,qx,qy,qz\n1,2,3,4,5,6,1,0,0,0\n"
    found = parse_pose_file(text)
    np.testing.assert_array_equal(found.wrenches, [[1, 2, 3, 4, 5, 6]])
    np.testing.assert_array_equal(found.base_R_sensor.magnitude(), [0.0])
    assert found.roles == (PoseRole.FIT,)


def test_roles_split_the_record() -> None:
    text = f"{HEADER},role\n{GOOD},fit\n{GOOD},Hold-out\n{GOOD},\n{GOOD},repeat\n"
    found = parse_pose_file(text)
    assert len(found.having(PoseRole.FIT).roles) == 2
    assert len(found.having(PoseRole.HOLD_OUT).roles) == 1
    assert found.having(PoseRole.REPEAT).wrenches.shape == (1, 6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        (HEADER, "no line of data"),
        (HEADER.replace(",fz_n", ""), "missing column fz_n"),
        (HEADER + ",qx\n" + GOOD + ",0", "more than once"),
        (HEADER + "\n0,0,0,1,1,2,3,4,5", "line 2, column mz_nm: .* nothing"),
        (HEADER + "\n" + GOOD + ",7", "line 2: more fields"),
        (HEADER + "\n" + GOOD + "\n0,0,0,1,one,2,3,4,5,6", "line 3, column fx_n: .*'one'"),
        ("# one\n# two\n" + HEADER + "\n" + GOOD + ",7", "line 4: more fields"),
        (HEADER + "\n0,0,0,1,nan,2,3,4,5,6", "not finite"),
        (HEADER + "\n0,0,0,1,1,2,3,4,5,inf", "not finite"),
        (HEADER + "\n0,0,0,2,1,2,3,4,5,6", "length 2"),
        (HEADER + "\n0,0,0,0,1,2,3,4,5,6", "length 0"),
        (HEADER + ",role\n" + GOOD + ",maybe", "'maybe' is none of"),
    ],
)
def test_bad_files_are_refused_by_line_and_column(text: str, message: str) -> None:
    with pytest.raises(PayloadFileInvalid, match=message):
        parse_pose_file(text)
