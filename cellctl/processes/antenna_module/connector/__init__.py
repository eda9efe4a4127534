"""Drawings of connectors and of the gripper's marks, read from files and checked.

``arrangement`` compares patterns of points under turns and mirrors, ``connector`` and ``marks`` are
the two drawings, ``toml_file`` reads either.
"""
