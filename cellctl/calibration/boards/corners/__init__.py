"""The corners of a board in one image, or the centres of its circles.

``corner_detection`` is the way in. For a chessboard ``board_search`` finds the corners in a reduced
image, for a ChArUco board the markers do; ``corner_saddle`` and OpenCV's gradient method refine
them in the full one. ``circle_search`` finds a grid of circles, ``circle_centres`` measures their
rims.
"""
