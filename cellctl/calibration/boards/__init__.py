"""Boards that calibrations look at, and where they are in images and in space.

``board`` is a chessboard, a ChArUco board or a grid of circles. ``corners`` finds it in one image
and ``board_images`` in all images of a calibration, with the reason where it is not found.
``board_shape`` and ``known_board`` say how far a printed board is off its drawing.
``board_in_camera`` gives its pose in one camera with the lens model of ``projection``.
``board_pose`` is the target board of discs, seen by stereo and large-field heads.
"""
