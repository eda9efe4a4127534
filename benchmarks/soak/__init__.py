"""``make soak``: a cell makes part after part, and none of its processes may keep anything.

``cell`` runs the cycles and looks at the processes after each, ``trend`` judges what they kept,
``chart`` draws it.
"""
