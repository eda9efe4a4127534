import io
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh
from matplotlib.image import imread

from cellctl.config.devices import WayConfig
from cellctl.planning.pictures.frusta import Frustum, frusta
from cellctl.planning.pictures.glb import cell_glb
from cellctl.planning.pictures.paths import flange_paths
from cellctl.planning.pictures.views import three_views
from cellctl.planning.views.plan_viewpoints import stated_measurements
from cellctl.planning.views.prediction import part_in_cell
from tests.unit.planning.deck_cell import deck_scene


def test_the_glb_has_every_body_where_the_model_has_it() -> None:
    scene = deck_scene()
    read = trimesh.load_scene(
        io.BytesIO(cell_glb(scene, tuple(frusta(scene)), tuple(flange_paths(scene)))),
        file_type="glb",
    )
    assert {"frame", "main.deck at home", "main.deck at deck_measure"} <= set(read.geometry)
    frame = read.geometry["frame"]
    assert np.allclose(frame.bounds, [[1.65, -0.5, 0.38], [2.15, 0.5, 0.4]], atol=1e-6)


@cache
def without_lines() -> bytes:
    return three_views(deck_scene(), (), ())


def test_the_picture_shows_arms_and_stand_ins() -> None:
    image = imread(io.BytesIO(without_lines()))
    colours = {tuple((pixel[:3] * 7).astype(int)) for row in image[::5] for pixel in row[::5]}
    assert image.shape[1] > 1200
    assert len(colours) > 5


def within(view: Frustum, points_m: np.ndarray) -> np.ndarray:
    """Whether each point lies on the inner side of every face of a frustum."""
    mesh = view.mesh()
    from_face_m = points_m[:, None] - mesh.triangles_center
    return np.asarray((np.einsum("nfi,fi->nf", from_face_m, mesh.face_normals) < 0.0).all(axis=1))


def test_each_head_sees_the_holes_that_it_measures_and_not_those_of_the_other() -> None:
    scene = deck_scene()
    views = {one.name: one for one in frusta(scene)}
    assert set(views) == {
        f"head_{number} at measuring, {side}" for number in (1, 2) for side in ("left", "right")
    }
    (measurement,) = stated_measurements(scene)
    bases = {name: arm.cell_T_base for name, arm in scene.arms.items()}
    for part in measurement.parts:
        for name, holes in part.seen.items():
            places_m = part_in_cell(part, bases).apply([hole.position_m for hole in holes])
            for side in ("left", "right"):
                for head in ("head_1", "head_2"):
                    inside = within(views[f"{head} at measuring, {side}"], places_m)
                    assert bool(inside.all() if head == name else inside.any()) is (head == name)


def test_a_path_goes_through_the_points_of_its_way() -> None:
    scene = deck_scene()
    main = scene.arms["main"]
    via_deg = (5.0, -85.0, 84.0, 20.0, 70.0, 90.0)
    way = WayConfig(start="home", end="deck_measure", via_deg=(via_deg,))
    config = main.config.model_copy(update={"ways": (way,)})
    arms = {**scene.arms, "main": replace(main, config=config)}
    paths = {path.name: path.points_m for path in flange_paths(replace(scene, arms=arms))}
    assert set(paths) == {
        "main: home to deck_measure",
        "aux_1: retracted to measuring",
        "aux_2: retracted to measuring",
    }
    via_m = (main.cell_T_base * main.base_T_flange(np.radians(via_deg))).translation
    off_m = np.linalg.norm(paths["main: home to deck_measure"] - via_m, axis=1)
    assert off_m.min() < 1e-9


@pytest.mark.figures  # beside the picture of arms and stand-ins
def test_lines_of_sight_and_ways_are_drawn() -> None:
    scene = deck_scene()
    assert three_views(scene, tuple(frusta(scene)), ()) != without_lines()
    assert three_views(scene, (), tuple(flange_paths(scene))) != without_lines()
