"""Everything that runs in the process of the maker's library (GenTL, harvesters), and nowhere else.

``entry`` starts it, ``child`` answers one request after the other; ``producers`` and ``selection``
find a camera, ``genicam_camera`` opens it; ``features``, ``chunks``, ``delivered`` speak with it.
"""
