"""The cameras of a stereo head: calibration, rays and pixels, planes, two rays to a point.

Frames: ``camera`` is x right, y down, z forward; the frame of a head is that of its left camera.
Raw pixels are those of the image as it comes, with the distortion of the lens; the centre of the
upper left pixel is (0, 0). Rays are undistorted and normalised to z = 1.
"""
