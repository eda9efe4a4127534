"""46x–47x, 597: electrical connectors and gripper marks, measured in one image and a known plane.

ConnectorError
├── ConnectorFileInvalid, MarksFileInvalid, PlaneFileInvalid    460–462  inputs
├── ForeignIntrinsics, PlaneScaleWrong                          464 465  the set of calibrations
├── ConnectorMissing, ConnectorAmbiguous, WrongConnector        466–468  which connector
├── ConnectorTurned, ImageMirrored                              469 470  which way round
├── ConnectorMisplaced                                          471      where
├── ContactMissing, ContactBent, ContactHidden                  472–474  single contacts
├── MarksMissing                                                475      gripper marks
├── ConnectorUncertain                                          476      how well
├── PaperMethodRefused                                          477      the method of the paper
├── LightFromOneSide                                            478      the lamp
└── PixelsNotMeasurable                                         597      the form of the image
"""

from cellctl.errors.base import Reaction
from cellctl.errors.vision import VisionError


class ConnectorError(VisionError):
    """A connector could not be measured, or is not as its drawing says."""

    reaction = Reaction.STOP


class ConnectorFileInvalid(ConnectorError):
    """The drawing of a connector cannot be used."""

    number = 460
    text = "Connector file cannot be used"
    cause = "The file is missing, not TOML, incomplete, or contradicts itself."
    remedy = "Correct the connector file at the place named in the detail."


class MarksFileInvalid(ConnectorError):
    """The drawing of the gripper's marks cannot be used."""

    number = 461
    text = "File of gripper marks cannot be used"
    cause = "The file is missing, not TOML, incomplete, or the marks look alike when turned."
    remedy = "Correct the file of marks at the place named in the detail."


class PlaneFileInvalid(ConnectorError):
    """The plane in which pixels become millimetres cannot be used."""

    number = 462
    text = "Plane file cannot be used"
    cause = "The file is missing, not JSON, incomplete, or the plane is not before the camera."
    remedy = "Calibrate the plane with this camera again."


class ForeignIntrinsics(ConnectorError):
    """The plane was calibrated with other intrinsics than the image is measured with."""

    number = 464
    text = "Plane and camera calibration do not belong together"
    cause = "The intrinsics were exchanged after the plane was calibrated, or are another camera's."
    remedy = "Use the camera file with the identity in the detail, or calibrate the plane again."


class PlaneScaleWrong(ConnectorError):
    """The connector appears larger or smaller than its drawing."""

    number = 465
    text = "Connector has the wrong size in the image"
    cause = (
        "Wrong height of the plane, intrinsics of another lens, or a connector of another pitch."
    )
    remedy = "Check the camera's distance, its calibration and the connector file."


class ConnectorMissing(ConnectorError):
    """Nothing in the image looks like contacts of this size."""

    number = 466
    text = "Connector was not found"
    cause = "No part in view, wrong light, wrong kind (pins or holes), or a wrong plane."
    remedy = "Look at the image; check part, light and connector file."


class ConnectorAmbiguous(ConnectorError):
    """More than one place or orientation fits what is seen."""

    number = 467
    text = "Connector fits in more than one way"
    cause = (
        "The drawing looks the same after half a turn, or contacts are missing that would tell the "
        "two ways apart."
    )
    remedy = "State the expected place in the plane file, or measure with the gripper's marks."


class WrongConnector(ConnectorError):
    """Contacts are there, but not in the arrangement of the drawing."""

    number = 468
    text = "Contacts do not fit the connector file"
    cause = "Another connector than the file describes, or a very dirty one."
    remedy = "Compare part and connector file; clean the connector."


class ConnectorTurned(ConnectorError):
    """The connector lies half a turn from where it is expected."""

    number = 469
    text = "Connector is turned by 180°"
    cause = "Module gripped or laid down the wrong way round, or the image is turned."
    remedy = "Turn the module; check the orientation in the camera's settings."


class ImageMirrored(ConnectorError):
    """The image shows a mirror image of the drawing."""

    number = 470
    text = "Image or drawing is mirrored"
    cause = (
        "A mirror setting of the camera, a program that saved the image flipped, or a drawing of "
        "the part as seen from its back."
    )
    remedy = (
        "If the image is mirrored, restore the settings with which the camera was calibrated. If "
        "the drawing is, give x of every place in it the other sign. Not both."
    )


class ConnectorMisplaced(ConnectorError):
    """The connector is far from where it is expected."""

    number = 471
    text = "Connector is not where it is expected"
    cause = "Gripped off its place, wrong pose of the robot, or a moved camera."
    remedy = "Look at the picture; lay the module down and pick it again."


class ContactMissing(ConnectorError):
    """A contact of the drawing is not there."""

    number = 472
    text = "A contact is missing"
    cause = "Pin broken off or not assembled, or hole blocked."
    remedy = "Look at the picture: broken off or covered? Put the module into quarantine."


class ContactBent(ConnectorError):
    """A contact is off its place by more than its true position explains."""

    number = 473
    text = "A contact is bent"
    cause = "Pin bent in transport or by an earlier plugging."
    remedy = "Look at the picture; put the module into quarantine."


class ContactHidden(ConnectorError):
    """A contact's rim is not seen well enough."""

    number = 474
    text = "A contact is hidden or dirty"
    cause = "Dirt or a reflection on the contact, or something between camera and connector."
    remedy = "Clean the connector and the lens, then look again."


class MarksMissing(ConnectorError):
    """The gripper's marks were not found, or fit their drawing badly."""

    number = 475
    text = "Gripper marks were not found"
    cause = "Marks dirty, covered or out of view, another gripper, or the wrong file."
    remedy = "Clean the marks; check file and camera."


class ConnectorUncertain(ConnectorError):
    """The image is too poor for the accuracy that is asked for."""

    number = 476
    text = "Connector was measured too uncertainly"
    cause = "Noise, blur, weak contrast, or too few good contacts."
    remedy = "Improve focus and light, clean the connector, or average more images."


class PaperMethodRefused(ConnectorError):
    """The paper's method did not find exactly the contacts of the drawing."""

    number = 477
    text = "The paper's method did not find every contact"
    cause = "Mean and line through the contacts mean nothing unless all of them are there."
    remedy = "Use the default method, which names the contact; clean the connector."


class LightFromOneSide(ConnectorError):
    """The contacts are lit from one side, and would be measured towards the lamp."""

    number = 478
    text = "Connector is lit from one side"
    cause = "Part of the ring light has failed or is covered, or daylight falls in from one side."
    remedy = "Check the lamp and what shades it; the contacts must be lit alike from all sides."


class PixelsNotMeasurable(ConnectorError):
    """An image comes in a form in which nothing is measured."""

    number = 597
    text = "Images of this camera cannot be measured"
    cause = "A driver that hands on samples of 16 bits and does not say how many of them count."
    remedy = "Set the camera to Mono8, or to the mosaic of a colour camera, such as BayerRG8."
