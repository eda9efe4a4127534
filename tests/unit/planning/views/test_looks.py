import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.planning.views.gains import with_baseline
from cellctl.planning.views.looks import HeadLook, grid_of_looks, left_T_middle, look_of
from tests.unit.planning.views.deck_views import measurement

AIM = RigidTransform.from_components(
    [1.9, 0.4, 0.4], Rotation.from_euler("ZYX", [20.0, 5.0, 180.0], degrees=True)
)
HEAD = measurement().heads[0].camera
small = st.floats(-0.6, 0.6)


@given(st.builds(HeadLook, st.floats(0.2, 2.0), small, small, st.floats(-3.1, 3.1), small, small))
def test_a_place_gives_its_look_back(look: HeadLook) -> None:
    again = look_of(look.cell_T_middle(AIM), AIM)
    between = look.cell_T_middle(AIM).inv() * again.cell_T_middle(AIM)
    assert np.allclose(between.as_matrix(), np.eye(4), atol=1e-9)


def test_the_grid_has_looks_from_all_sides_within_the_focus() -> None:
    looks = list(grid_of_looks(0.4, 0.7))
    assert len(looks) == len(set(looks)) == 1500
    assert all(0.4 < look.distance_m < 0.7 for look in looks)


def test_another_baseline_keeps_the_place_where_both_lines_of_sight_meet() -> None:
    longer, middle_T_left = with_baseline(HEAD, 1.5)
    ratio = np.linalg.norm(longer.translation_m) / np.linalg.norm(HEAD.translation_m)
    assert abs(ratio - 1.5) < 0.01
    same, place = with_baseline(HEAD, 1.0)
    assert np.allclose(same.rotation, HEAD.rotation)
    assert np.allclose(place.as_matrix(), left_T_middle(HEAD).inv().as_matrix())
    assert middle_T_left.translation[0] < place.translation[0] < 0.0
