"""Boards that calibrations look at, and where they are in images and in space.

A chessboard or ChArUco board (``board``) is found in images by ``board_search`` and
``board_images``; ``board_in_camera`` gives its pose in one camera with the lens model of
``projection``. ``board_pose`` is the target board of discs, seen by stereo and large-field heads.
"""
