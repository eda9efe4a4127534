"""From two images of a part to its pose, with the uncertainty of both.

The walk of one stereo pair, from the top:

1. ``measure.measure_pair`` takes the images of one head, its calibration (``camera.stereo_head``)
   and the holes of the drawing (``features``). Images that cannot carry a measurement are refused
   (``camera.image_checks``).
2. ``holes`` finds round features in both images, pairs them between the cameras and assigns them to
   the holes of the drawing by their mutual distances. Each rim is then located by its edges, in the
   plane in which the drawing says that it lies.
3. ``rim`` measures each located rim in both images to some thousandths of a pixel.
4. ``camera.triangulation`` turns both centres into a point in the left camera, and the result is
   checked against the drawing. When two arrangements fit equally well, the pair is refused.
5. ``registration.part_pose`` registers the points of one or two heads on the drawing: the pose of
   the part with its full covariance.

``paper_baseline`` holds the published image steps as a named baseline. Everything here is a pure
function from arrays to frozen values: no device, no file but the two formats read in ``features``
and ``camera``, no clock. Sub-packages import only from those before them in this order: ``camera``,
``features``, ``registration``, ``rim``, ``holes``.
"""
