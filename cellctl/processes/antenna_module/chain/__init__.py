"""From two looks to the flange pose at which the plug sits before its socket.

Knows no image and no device: poses with covariance go in, a pose with covariance comes out.
Frames: ``base``, ``flange``; ``cam1`` on the flange, ``cam2`` fixed; ``plug`` and ``socket`` lie
at the connectors, ``marks`` on the gripper, ``plate`` beside camera II.

- ``looks``: what was seen, and where the flange was
- ``cell_figures``: what calibrations and the robot's data sheet say
- ``termed_pose``: a pose whose covariance is kept apart by its causes
- ``schemes``: four ways to ``flange_T_plug``, by name
- ``plan``: composes, predicts, refuses
- ``teaching``: the correction from taught plugs, and the gripper marks by turning them
- ``reference``: which device has moved
"""
