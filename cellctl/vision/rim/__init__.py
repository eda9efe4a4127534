"""The rim of a hole: located by its edges, then measured by fitting a model of what it looks like.

The walk of one rim through this package:

1. ``roi`` says where to look in each image and finds the rim by its ``edges``, to some tenths of a
   pixel, as the circle on which most azimuths agree.
2. ``fit_input`` takes the pixels round it, in the coordinates of the rim's plane, where lens
   distortion and perspective are gone and the rim is a circle.
3. ``selection`` fits each image with an even dark disc and asks by score tests whether a wall must
   be modelled too. The kind of the hole then decides whether a second edge, of a chamfer or of a
   narrow cone, must be fitted in both images at once.
4. A fit is a least-squares ``problem``: ``shape`` gives the borders between the surfaces at a rim,
   ``light`` their grey values, ``noise`` the weights. ``solver`` minimises it. Where no model
   explains the whole rim, ``arcs`` that are off its circle leave the fit.
5. ``covariance`` adds to the uncertainty what the residuals show of texture and of an imperfect
   model.
6. ``stereo_fit`` is the entry: it drives all this, refuses what is no rim, and returns both
   centres in raw pixels with their joint covariance.
7. ``shown_spread`` tells from all rims of an image whether it has moved or is out of focus
   (``spread``). If so, ``cellctl.vision.measure`` has all of them fitted anew with that;
   ``image_scale`` says what all of them leave unexplained.
"""
