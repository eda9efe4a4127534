"""4xx: images, holes and part poses.

VisionError
├── CalibrationFileInvalid, FeatureFileInvalid, ImageFileInvalid     401 402 403  inputs
├── ImageSizeMismatch, ImageBlack, ImageSaturated, ImageBlurred      411–414      one image
├── CamerasSwapped, CameraUpsideDown                                 415 416      the pair
├── HoleMissing, HoleAmbiguous, TooFewHoles, DrawingMirrored         421–424      features
├── ResidualsTooLarge, HeadsMoved                                    431 433      the pose
└── CameraFileInvalid                                                463          one camera
"""

from cellctl.errors.base import CellError, Reaction


class VisionError(CellError):
    """A measurement could not be made or trusted."""


class CalibrationFileInvalid(VisionError):
    """A stereo calibration file cannot be used."""

    number = 401
    text = "Stereo calibration file cannot be used"
    cause = "The file is missing, not JSON, incomplete, or holds impossible values."
    remedy = "Make a new file with `cellctl calibrate stereo`."
    reaction = Reaction.STOP


class FeatureFileInvalid(VisionError):
    """A feature file cannot be used."""

    number = 402
    text = "Feature file cannot be used"
    cause = "The file is missing, not TOML, incomplete, or names a hole twice."
    remedy = "Correct the file at the place named in the detail."
    reaction = Reaction.STOP


class ImageFileInvalid(VisionError):
    """An image file cannot be read."""

    number = 403
    text = "Image file cannot be used"
    cause = "The file is missing, cut off, not an image, or not 8 bit."
    remedy = "Give an 8 bit image as the camera delivered it."
    reaction = Reaction.STOP


class ImageSizeMismatch(VisionError):
    """The image has another size than the calibration."""

    number = 411
    text = "Image size does not match the calibration"
    cause = "Calibration of another camera, or the image was cropped or scaled."
    remedy = "Use the calibration of this head and images at full resolution."


class ImageBlack(VisionError):
    """The image carries no light."""

    number = 412
    text = "Image is black"
    cause = "Lamp off, lens cap on, exposure far too short, or a camera fault."
    remedy = "Check lamp, lens and exposure time."


class ImageSaturated(VisionError):
    """Large parts of the image are at full scale."""

    number = 413
    text = "Image is saturated"
    cause = "Exposure too long, or a reflection of the lamp."
    remedy = "Shorten the exposure or change the lamp's angle."


class ImageBlurred(VisionError):
    """The image has neither the sharpness nor the contrast that a measurement needs."""

    number = 414
    text = "Image is blurred or has too little contrast"
    cause = "Out of focus, motion during exposure, dirt on the lens, or too little light."
    remedy = "Check working distance, focus, exposure and cleanliness of the lens."


class CamerasSwapped(VisionError):
    """The pair fits the calibration only with left and right exchanged."""

    number = 415
    text = "Left and right images are exchanged"
    cause = "Cameras or files given in the wrong order."
    remedy = "Exchange the two cameras in the head's configuration, or the two files."


class CameraUpsideDown(VisionError):
    """The pair fits the calibration only with one image turned by 180°."""

    number = 416
    text = "One camera's image is upside down"
    cause = "The image is turned by 180° in the camera's settings, or the camera was remounted."
    remedy = "Restore the orientation that the head was calibrated with."


class HoleMissing(VisionError):
    """A named hole was not found."""

    number = 421
    text = "A hole was not found"
    cause = (
        "Part not in view, hole covered or damaged, wrong feature file, or light under which the "
        "hole is not darker than the face round it."
    )
    remedy = (
        "Look at the picture; check part, light and feature file. Where all holes are seen and "
        "none fits, check the square size that the head was calibrated with."
    )


class HoleAmbiguous(VisionError):
    """More than one assignment of image features to holes fits."""

    number = 422
    text = "A hole cannot be told from another feature"
    cause = "A mark of the same size near the hole, or a layout that fits in two ways."
    remedy = (
        "Clean the part, state `outward_axis` in the feature file, "
        "or choose holes with an unequal layout."
    )


class TooFewHoles(VisionError):
    """Fewer than three holes that do not lie on a line."""

    number = 423
    text = "Too few holes for a pose"
    cause = "Holes were rejected, or those left lie on a line."
    remedy = "Look at the picture and at the residuals of the rejected holes."


class DrawingMirrored(VisionError):
    """The holes fit the drawing in a mirror only, or nothing says that they do not."""

    number = 424
    text = "The drawing is mirrored against the part"
    cause = (
        "It shows the part from its back, one of its axes has the wrong sign, or `outward_axis` "
        "points into the part."
    )
    remedy = (
        "Compare picture and drawing. If they are mirrored, give x of every hole the other sign; "
        "if they are not, correct `outward_axis`, or state it."
    )


class ResidualsTooLarge(VisionError):
    """The measured holes do not fit the drawing."""

    number = 431
    text = "Measured holes do not fit their nominal positions"
    cause = "Wrong feature file, a wrongly detected hole, a moved head, or an outdated calibration."
    remedy = "Look at the residuals; check feature file and head calibration."


class HeadsMoved(VisionError):
    """Each head sees the holes where they should be, and both together do not."""

    number = 433
    text = "The two heads no longer stand to each other as they were calibrated"
    cause = "A head was touched, or its robot was moved or mastered anew; or a part of two pieces."
    remedy = "Look at both heads, their robots and the part; then calibrate boards 1 and 2 again."


class CameraFileInvalid(VisionError):
    """The calibration of a single camera cannot be used."""

    number = 463
    text = "Camera file cannot be used"
    cause = "The file is missing, not JSON, incomplete, or was changed after it was made."
    remedy = "Calibrate the camera again, or restore the file as it was made."
    reaction = Reaction.STOP


OF_AN_IMAGE = (
    ImageSizeMismatch,
    ImageBlack,
    ImageSaturated,
    ImageBlurred,
    CamerasSwapped,
    CameraUpsideDown,
)
"""Faults of an image itself or of its camera, whatever the image shows."""
