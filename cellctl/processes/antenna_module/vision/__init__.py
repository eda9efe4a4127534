"""Measures a connector and the gripper's marks in one image of one camera and a known plane.

The path of an image:
- ``pixels``: from the file to the one plane of grey values that is measured;
- ``contact_fit.spots``: where something round of the right size is;
- ``matching``: which spot is which contact, and whether another assignment fits as well;
- ``contact_fit``: sub-pixel edges along rays, a robust circle with its covariance, tips of pins;
- ``planar_fit``: x, y and yaw of the drawing, contacts off their place left out;
- ``pattern``: these four one after another, for contacts and for marks;
- ``measure``: the verdicts on contacts, orientation, place and scale; the entrance.

``plane`` holds the geometry, ``paper_method`` the method of the paper as the named baseline,
``result_file`` and ``picture`` what is handed out.

Only x, y and yaw are estimated. Tilt and height follow so badly from contacts a few millimetres
apart that they are taken from the calibrated plane, with its stated uncertainty.
"""
