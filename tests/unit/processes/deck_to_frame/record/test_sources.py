"""What the record keeps of a measurement, held against the picture that it was made in."""

from pathlib import Path

import numpy as np
import pytest
import zstandard
from scipy.spatial import KDTree

from cellctl.clock import now_s, utc_now
from cellctl.geometry.pose import Array
from cellctl.interfaces import StereoPair
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement
from cellctl.processes.deck_to_frame.record.sources import rims, view_name
from cellctl.records import RunResult, RunStore
from cellctl.records.files.raw_images import MEDIA_TYPE
from cellctl.records.looks import TakenImage, documents_of_look
from cellctl.records.run_mcap.export import export_mcap
from cellctl.vision.camera.lens import project
from cellctl.vision.features.hole import Hole
from cellctl.vision.measure import measure_pair
from cellctl.vision.registration.part_pose import part_pose
from tests.unit.records.conftest import start
from tests.unit.records.run_mcap.reading import read
from tests.unit.vision.plates import Light, cut_head, holes_triangle, plate_facing, render_pair

HEAD, HOLES, C1_T_PLATE = cut_head(), holes_triangle(), plate_facing(4.0, -6.0, 3.0)
VIEW = view_name(1, "left")
VIEWER_PX = 0.5
"""Viewers count pixels from the corner of the first one, cameras from its centre."""
MOST_OFF_PX = 0.1


def true_rim(hole: Hole) -> Array:
    """Where the rim is in the left image, in pixels of a viewer, shape (n, 2)."""
    angles = np.linspace(0.0, 2 * np.pi, 20_000, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    rim = C1_T_PLATE.apply(hole.position_m + circle * hole.diameter_m / 2)
    return project(HEAD.left, rim) + VIEWER_PX


def test_an_exported_outline_lies_on_the_rim_in_its_picture(tmp_path: Path) -> None:
    left, right = render_pair(HEAD, C1_T_PLATE, HOLES, Light())
    found = measure_pair(left, right, HEAD, HOLES, camera_T_part=C1_T_PLATE)
    pair = StereoPair(left, right, now_s(), 1)
    measured = PartMeasurement(
        part_pose(found, None, None, HOLES), (found, found), (pair, pair), 1, C1_T_PLATE
    )
    store = RunStore(tmp_path / "store")
    run, file = start(store), f"raw/frame-frame-1-{VIEW}.pgm.zst"
    taken = {file: TakenImage("frame", VIEW, utc_now())}
    store.add(run, *documents_of_look("frame", taken, {VIEW: rims(measured)[VIEW]}))
    plain = b"P5 %d %d 255\n" % left.shape[::-1] + left.tobytes()
    store.add_artefact(run, file, zstandard.compress(plain), MEDIA_TYPE)
    store.close_run(run, RunResult.GOOD)
    content = read(export_mcap(store, run, tmp_path / "run.mcap").path)
    store.close()
    (image,) = content.of(f"/images/{VIEW}")
    assert (image.width, image.height) == HEAD.image_size
    (drawn,) = content.of(f"/images/{VIEW}/annotations")
    assert len(drawn.points) == len(HOLES)
    for hole, outline in zip(HOLES, drawn.points, strict=True):
        corners = np.array([(point.x, point.y) for point in outline.points])
        off_px = np.asarray(KDTree(true_rim(hole)).query(corners)[0])
        assert off_px.max() < MOST_OFF_PX, hole.name
        assert corners.mean(axis=0) == pytest.approx(true_rim(hole).mean(axis=0), abs=MOST_OFF_PX)
