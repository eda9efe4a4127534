"""From measured points to the pose of a part.

``average`` combines frames of one scene. ``part_pose`` registers the points of one or two heads on
the drawing by the weighted ``rigid_fit``, and ``chi_square`` tells whether the stated uncertainties
explain what the fit leaves. ``paper_frame`` is the frame of the paper, for its baseline.
"""
