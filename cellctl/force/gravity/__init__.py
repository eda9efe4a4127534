"""The payload of a force sensor: its identification from still poses, and its weight.

The walk: ``poses`` plans where to measure, ``pose_file`` holds what was measured, ``excitation``
refuses poses that cannot tell the load, ``payload`` fits it, ``acceptance`` tests the fit, and
``payload_result`` joins these into the one function behind procedure and command. What is used
afterwards is ``gravity_compensation``.
"""
