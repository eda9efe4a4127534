import io

import numpy as np
import trimesh
from matplotlib.image import imread

from cellctl.planning.pictures.glb import cell_glb
from cellctl.planning.pictures.views import three_views
from tests.unit.planning.deck_cell import deck_scene


def test_the_glb_has_every_body_where_the_model_has_it() -> None:
    scene = deck_scene()
    read = trimesh.load_scene(io.BytesIO(cell_glb(scene)), file_type="glb")
    assert {"frame", "main.deck at home", "main.deck at deck_measure"} <= set(read.geometry)
    frame = read.geometry["frame"]
    assert np.allclose(frame.bounds, [[1.65, -0.5, 0.38], [2.15, 0.5, 0.4]], atol=1e-6)


def test_the_picture_shows_arms_and_stand_ins() -> None:
    image = imread(io.BytesIO(three_views(deck_scene())))
    colours = {tuple((pixel[:3] * 7).astype(int)) for row in image[::5] for pixel in row[::5]}
    assert image.shape[1] > 1200
    assert len(colours) > 5
