"""Calibration boards: white discs, chessboard, ChArUco; bowed where they are."""

import numpy as np

from fakes.render.bodies.faces import draw_face
from fakes.render.bodies.prints import charuco_print, chessboard_print, white_share
from fakes.render.model import SceneCharucoBoard
from fakes.render.optics.canvas import Image, Patch, margin_px
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import NODES_FULL, Window, window_around
from fakes.render.optics.lens import View
from fakes.render.optics.surface import Height, face_map, surface_map, to_pixels
from fakes.render.options import RenderOptions
from fakes.world.scene import SceneChessboard, SceneTargetBoard


def draw_target_board(
    view: View, image: Image, board: SceneTargetBoard, options: RenderOptions, blur_px: float
) -> list[Patch]:
    """Lay the dark plate over ``image``; its white discs are returned, blurred, for later."""
    x, y = face_map(view, board.camera_T_board)
    draw_face(image, x, y, board.size_m, options.black_grey)
    radius_m = board.disc_diameter_m / 2
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    rim = radius_m * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(48)])
    patches = []
    for disc in board.discs:
        middle = np.array([*disc.position_m, 0.0])
        pixels = to_pixels(view, board.camera_T_board, rim + middle)
        window = window_around(view, pixels, margin_px(blur_px), options.sub_samples)
        if window is None:
            continue
        x_disc, y_disc = surface_map(view, board.camera_T_board, window)
        # Discs are drawn in the plane of the board, where each is a circle. Perspective and lens
        # make an oval of it, so that the centre of the image ellipse is not the image of the
        # centre, as in reality.
        outside = coverage(np.hypot(x_disc - middle[0], y_disc - middle[1]) - radius_m)
        patches.append(Patch.of_one_grey(window, outside, options.white_grey, blur_px))
    return patches


def draw_chessboard(
    view: View,
    image: Image,
    board: SceneChessboard | SceneCharucoBoard,
    options: RenderOptions,
    blur_px: float,
) -> list[Patch]:
    """Lay white paper over ``image``; its print is returned, blurred, for later."""
    if isinstance(board, SceneChessboard):
        pattern = chessboard_print(board)
    else:
        pattern = charuco_print(board)
    window = Window.full(view)
    # A bow moves the corners in the image by parallax. That is what a calibration with an assumed
    # flat board gets wrong, so it must be in the picture.
    x, y = surface_map(view, board.camera_T_board, window, z_m=_bow(board), nodes=NODES_FULL)
    draw_face(image, x, y, board.size_m, options.white_grey)
    # A factor in place of a grey lets the print take the light that falls on the paper.
    dark = np.float32(options.black_grey / options.white_grey)
    return [Patch(window, dark + (1 - dark) * white_share(pattern, x, y, blur_px))]


def _bow(board: SceneChessboard | SceneCharucoBoard) -> float | Height:
    bow_x, bow_y = board.bow_m
    if bow_x == 0 and bow_y == 0:
        return 0.0
    half_x, half_y = board.size_m[0] / 2, board.size_m[1] / 2
    return lambda x, y: bow_x * (1 - (x / half_x) ** 2) + bow_y * (1 - (y / half_y) ** 2)
