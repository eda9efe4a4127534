"""One strategy per kind of hole: what the kinds say, and that nobody compares their names."""

import ast
from pathlib import Path

import numpy as np
import pytest

import cellctl.vision
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.hole_kind import HoleKind
from cellctl.vision.features.known_kinds import KINDS, by_brightness, kind_of


class Evidence:
    """What two images show of a rim, as stated."""

    def __init__(
        self,
        gains: tuple[float, float] = (0.0, 0.0),
        clear_px: tuple[float, float] = (np.inf, np.inf),
        *,
        hole: Hole | None = None,
        converged: bool = True,
        uneven: bool = False,
        dented: bool = False,
    ) -> None:
        self._hole = hole
        self.gains, self.clear_px = gains, clear_px
        self.converged, self.uneven, self.dented = converged, uneven, dented

    @property
    def hole(self) -> Hole:
        assert self._hole is not None
        return self._hole

    def in_radii(self, length_px: float, image: int = 0) -> float:
        return length_px / (20.0, 25.0)[image]

    def both_converged(self) -> bool:
        return self.converged

    def arcs_left_out(self) -> bool:
        return self.dented

    def ring_gains(self) -> tuple[float, float]:
        return self.gains

    def ring_seen(self) -> bool:
        return max(self.gains) > 15.0

    def uneven_inside(self) -> bool:
        return self.uneven


def hole(kind: str, countersink_m: float | None = None) -> Hole:
    return Hole("P1", kind, 6e-3, np.zeros(3), countersink_m)


@pytest.mark.parametrize("name", KINDS)
def test_a_kind_is_found_by_the_name_in_the_feature_file(name: str) -> None:
    assert isinstance(kind_of(hole(name)), HoleKind)
    assert kind_of(hole(name)).name == name


@pytest.mark.parametrize("name", KINDS)
def test_a_sharp_edge_needs_no_second_one(name: str) -> None:
    assert kind_of(hole(name)).second_edge(Evidence()) is None


def test_dark_and_bright_features_are_searched_apart() -> None:
    holes = [hole("disc"), hole("pin"), hole("thread")]
    groups = {bright: [one.kind for one in group] for bright, group in by_brightness(holes)}
    assert groups == {False: ["pin", "thread"], True: ["disc"]}
    assert [bright for bright, _ in by_brightness(holes[1:])] == [False]


def test_a_bore_is_deburred_when_both_images_together_say_so() -> None:
    assert KINDS["pin"].second_edge(Evidence((12.0, 12.0))) is None
    edge = KINDS["pin"].second_edge(Evidence((13.0, 13.0)))
    assert edge is not None
    assert edge.width == 0.07


def test_what_a_dent_leaves_of_itself_is_no_broken_edge() -> None:
    pin = KINDS["pin"]
    assert pin.second_edge(Evidence((60.0, 50.0), dented=True)) is None
    assert pin.second_edge(Evidence((300.0, 200.0), dented=True)) is not None


@pytest.mark.parametrize(
    "evidence", [Evidence((16.0, 0.0)), Evidence(converged=False), Evidence(uneven=True)]
)
def test_a_thread_is_fitted_with_a_chamfer_once_an_even_disc_fails(evidence: Evidence) -> None:
    edge = KINDS["thread"].second_edge(evidence)
    assert edge is not None
    assert edge.width == 0.1


def test_the_width_of_a_narrow_cone_comes_from_the_drawing_or_else_from_the_image() -> None:
    cone, silent = KINDS["countersink"], hole("countersink")
    near = (4.0, np.inf)
    stated = cone.second_edge(Evidence(clear_px=near, hole=hole("countersink", 6.9e-3)))
    seen = cone.second_edge(Evidence(clear_px=near, hole=silent))
    unseen = cone.second_edge(Evidence((20.0, 0.0), hole=silent))
    assert stated is not None
    assert seen is not None
    assert unseen is not None
    assert stated.width == pytest.approx(0.15)
    assert stated.sigma == pytest.approx(0.015)
    assert seen.width == pytest.approx(0.2)
    assert (unseen.width, unseen.sigma) == (0.15, 0.08)
    assert cone.second_edge(Evidence(clear_px=(6.0, 6.0), hole=silent)) is None


def test_no_module_compares_the_name_of_a_kind() -> None:
    folder = Path(next(iter(cellctl.vision.__path__)))
    compared = [
        f"{path.name}:{node.lineno}"
        for path in folder.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Compare)
        and any(isinstance(one, ast.Constant) and one.value in KINDS for one in node.comparators)
    ]
    assert compared == []
