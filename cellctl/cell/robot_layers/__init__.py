"""What stands between a command and the driver of a robot: slower, permitted, or noted.

Each layer is a ``Robot`` round another one (``robot_layer``), so that neither the driver nor
whoever commands it knows of it. ``cell/devices.py`` puts them on; ``cell/zones`` adds another.
"""
