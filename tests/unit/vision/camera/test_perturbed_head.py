from dataclasses import replace

import numpy as np
import pytest

from cellctl.vision.camera.perturbed_head import moved_head, perturbed_heads
from tests.unit.planning.views.deck_views import measurement

HEAD = measurement().heads[0].camera


def test_the_squares_of_all_changes_are_the_variances() -> None:
    assert HEAD.covariance is not None
    others = list(perturbed_heads(HEAD))
    focal = sum(
        (one.left.camera_matrix[0, 0] - HEAD.left.camera_matrix[0, 0]) ** 2 for one in others
    )
    place = sum((one.translation_m - HEAD.translation_m) ** 2 for one in others)
    assert focal == pytest.approx(HEAD.covariance[0, 0], rel=1e-6)
    assert place == pytest.approx(np.diag(HEAD.covariance)[-3:], rel=1e-6)


def test_nothing_is_known_of_a_head_without_covariance() -> None:
    assert list(perturbed_heads(replace(HEAD, covariance=None))) == []


def test_no_change_leaves_the_head() -> None:
    same = moved_head(HEAD, np.zeros(24))
    assert np.allclose(same.rotation, HEAD.rotation)
    assert np.allclose(same.right.distortion, HEAD.right.distortion)
