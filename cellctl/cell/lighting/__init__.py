"""Light on what cameras look at: lamps that are on while an image is exposed, and the exposure.

``light`` is a lamp at a digital output, ``lit_cameras`` switch it round each image, and
``auto_exposure`` finds the exposure time by the surface round the holes.
"""
