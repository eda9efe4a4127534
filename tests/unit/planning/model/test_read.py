from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from cellctl.errors import CellError
from cellctl.errors.config import (
    ArmNotDescribed,
    ConfigInvalid,
    ConfigUnreadable,
    MeshNotUsable,
    SizeImplausible,
)
from cellctl.planning.model.read import read_model
from tests.rigs.shipped import shipped_cell
from tests.unit.planning.deck_cell import DECK, deck_scene, write_model

CELL = shipped_cell(DECK.name)
DECK_BOX = "box = { size_mm = [1000.0, 500.0, 15.0], at = [0.0, 0.0, 509.5, 0.0, 0.0, 0.0] }"


def with_mesh(folder: Path, mesh: trimesh.Trimesh, unit: str = "mm") -> Path:
    mesh.export(folder / "deck.stl")
    keys = f'mesh = {{ file = "deck.stl", unit = "{unit}" }}'
    return write_model(folder, DECK_BOX, keys)


def test_the_shipped_model_says_what_is_a_guess() -> None:
    scene = deck_scene()
    guesses = {solid.name for solid in scene.solids if solid.stand_in}
    assert "main.forearm" in guesses
    assert not guesses & {"main.deck", "frame", "floor"}


def test_a_mesh_is_read_in_its_unit(tmp_path: Path) -> None:
    path = with_mesh(tmp_path, trimesh.creation.box((400.0, 200.0, 10.0)))
    scene = read_model(CELL, path, DECK.parent)
    (deck,) = [solid for solid in scene.solids if solid.name == "main.deck"]
    assert deck.shape.mesh().extents.tolist() == pytest.approx([0.4, 0.2, 0.01])


def test_an_open_mesh_is_refused(tmp_path: Path) -> None:
    mesh = trimesh.creation.box((400.0, 200.0, 10.0))
    mesh.update_faces(range(1, 12))
    with pytest.raises(MeshNotUsable, match="not closed"):
        read_model(CELL, with_mesh(tmp_path, mesh), DECK.parent)


def test_a_mesh_that_is_no_mesh_is_refused(tmp_path: Path) -> None:
    (tmp_path / "deck.stl").write_bytes(b"solid nothing")
    keys = 'mesh = { file = "deck.stl" }'
    with pytest.raises(MeshNotUsable):
        read_model(CELL, write_model(tmp_path, DECK_BOX, keys), DECK.parent)


@pytest.mark.parametrize(("size", "unit"), [(0.4, "mm"), (400.0, "m")])
def test_units_wrong_by_a_thousand_are_refused(tmp_path: Path, size: float, unit: str) -> None:
    path = with_mesh(tmp_path, trimesh.creation.box((size, size, size)), unit)
    with pytest.raises(SizeImplausible, match="expected"):
        read_model(CELL, path, DECK.parent)


def test_a_body_far_from_its_link_is_refused(tmp_path: Path) -> None:
    path = write_model(tmp_path, "to_mm = [0.0, 0.0, 960.0]", "to_mm = [0.0, 0.0, 9600.0]")
    with pytest.raises(SizeImplausible, match=r"main\.forearm"):
        read_model(CELL, path, DECK.parent)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("size_mm = [1000.0, 500.0, 15.0]", "size_mm = [1.0, 0.5, 0.1]", r"main\.deck: 1\.1 mm"),
        (
            "from_mm = [0.0, 0.0, 350.0], to_mm = [0.0, 0.0, 450.0], radius_mm = 350.0",
            "from_mm = [0.0, 0.0, 0.35], to_mm = [0.0, 0.0, 0.45], radius_mm = 0.35",
            r"main\.pedestal: 0\.8 mm",
        ),
        ("radius_mm = 180.0", "radius_mm = 0.18", r"main\.upper_arm: radius_mm = 0\.18 with"),
        ("[300.0, 160.0, 40.0]", "[300.0, 0.16, 40.0]", r"main\.fixture: 0\.16 mm in size_mm"),
        (
            "cell_T_base = [1900.0, -2300.0, 0.0, 90.0, 0.0, 0.0]",
            "cell_T_base = [1.9, -2.3, 0.0, 90.0, 0.0, 0.0]",
            r"main and aux_1: 3\.0 mm apart",
        ),
    ],
)
def test_metres_in_place_of_millimetres_are_refused(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    with pytest.raises(SizeImplausible, match=words):
        read_model(CELL, write_model(tmp_path, old, new), DECK.parent)


def test_a_thin_needle_that_is_short_is_a_body(tmp_path: Path) -> None:
    grip = "from_mm = [0.0, 0.0, 100.0], to_mm = [0.0, 0.0, 390.0], radius_mm = 100.0"
    needle = "from_mm = [0.0, 0.0, 100.0], to_mm = [0.0, 0.0, 130.0], radius_mm = 0.4"
    scene = read_model(CELL, write_model(tmp_path, grip, needle), DECK.parent)
    assert "main.gripper" in {solid.name for solid in scene.solids}


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("[robots.main]", "[robots.none]\n[robots.main]", ConfigInvalid),
        ("margin_mm = 20.0", "margin_mm = -20.0", ConfigInvalid),
        ("margin_mm = 20.0", "margin_mm = nan", ConfigInvalid),
        ("margin_mm = 20.0", "margins_mm = 20.0", ConfigInvalid),
        ('["main.deck", "frame"]', '["main.deck", "freme"]', ConfigInvalid),
        ("link = 1,", "link = 7,", ConfigInvalid),
        ("[robots.main]", "[robots.main", ConfigUnreadable),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, old: str, new: str, fault: type[CellError]) -> None:
    with pytest.raises(fault):
        read_model(CELL, write_model(tmp_path, old, new), DECK.parent)


def test_a_cell_without_a_model_is_told_what_to_write(tmp_path: Path) -> None:
    with pytest.raises(ConfigUnreadable, match=r"has no model yet.*docs/planning\.md"):
        read_model(CELL, tmp_path / "none.model.toml", DECK.parent)


def test_a_robot_that_the_cell_does_not_have_is_refused(tmp_path: Path) -> None:
    text = Path("config/deck.model.toml").read_text(encoding="utf-8").replace("aux_2", "aux_3")
    path = tmp_path / "model.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ArmNotDescribed, match="aux_3"):
        read_model(CELL, path, DECK.parent)


def test_an_arm_of_which_nothing_moves_is_refused(tmp_path: Path) -> None:
    text = Path("config/deck.model.toml").read_text(encoding="utf-8")
    start = text.index("turret", text.index("[robots.aux_1.bodies]"))
    path = tmp_path / "model.toml"
    path.write_text(text[:start] + text[text.index("[robots.aux_2]") :], encoding="utf-8")
    with pytest.raises(ArmNotDescribed, match="aux_1: all of its bodies stand on its base"):
        read_model(CELL, path, DECK.parent)


@given(st.binary(max_size=200))
def test_any_bytes_are_refused_with_a_number(content: bytes) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "deck.model.toml"
        path.write_bytes(content)
        with pytest.raises(CellError):
            read_model(CELL, path, DECK.parent)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "radius_mm = 350.0",
            "radus_mm = 350.0",
            r"line \d+: robots\.main\.bodies\.pedestal\.capsule\.radus_mm = 350\.0: no such key; "
            "did you mean 'radius_mm'",
        ),
        ("link = 0", "link = 7", r"line \d+: robots\.main\.bodies\.pedestal\.link = 7: 0 to 6"),
        ("margin_mm = 20.0", 'margin_mm = "20"', "a number, without quotes"),
    ],
)
def test_a_wrong_key_is_told_as_one_of_a_cell_file(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    with pytest.raises(ConfigInvalid, match=said):
        read_model(CELL, write_model(tmp_path, old, new), DECK.parent)


def test_rated_speeds_in_radians_are_refused(tmp_path: Path) -> None:
    """They count in the times that ways are chosen by."""
    degrees = "rated_deg_s = [80.0, 75.0, 70.0, 70.0, 70.0, 110.0]"
    path = write_model(tmp_path, degrees, "rated_deg_s = [1.4, 1.3, 1.2, 1.2, 1.2, 1.9]")
    with pytest.raises(SizeImplausible, match="degrees per second belong here"):
        read_model(CELL, path, DECK.parent)
