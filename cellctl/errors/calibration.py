"""6xx: calibration and its gate.

CalibrationError
├── BoardNotFound, WrongBoard, TooFewViews, MixedImageSizes          601–604  what the images show
├── CalibrationCamerasSwapped, CalibrationCameraUpsideDown,
│   PairsInconsistent, CameraSeenTwice                               605–608  how the pairs fit
├── BoardMirrored, KnownBoardDiffers                                   670–671  one board
├── PoorCoverage, IllConditioned, SolveFailed, ResultOutOfLimits     611–614  any calibration
├── AxisMotionInvalid                                                621      base frame
├── BoardPoseInvalid                                                 622      board transfer
├── PosesNotDiverse, RobotCameraMismatch, WristConfigurationsDiffer  623 624 564  hand-eye, tool
└── CalibrationRecordInvalid, CalibrationMissing, CalibrationExpired,
    CalibrationNotStored, CalibrationInvalidated, ClockNotTrusted,
    HeadPoseChanged                                                  631–637  stored results
"""

from cellctl.errors.base import CellError, Reaction


class CalibrationError(CellError):
    """A calibration failed or may not be used."""

    reaction = Reaction.STOP


class BoardNotFound(CalibrationError):
    """No image pair shows the calibration board whole and sharp."""

    number = 601
    text = "Calibration board was not found"
    cause = "Board not in view, partly covered, out of focus, or too dark."
    remedy = (
        "Look at the images named in the detail; the whole chessboard must be visible. In a "
        "procedure: lay the board where its guide says, and see that the taught pose shows it."
    )


class WrongBoard(CalibrationError):
    """The images show a board with another number of corners."""

    number = 602
    text = "The board in the images is not the one described"
    cause = "Another board or marker dictionary, or a wrong number of inner corners."
    remedy = (
        "Count inner corners, not squares: 10 x 7 squares have 9 x 6 inner corners. "
        "Give the marker dictionary that is printed on the board."
    )


class TooFewViews(CalibrationError):
    """Not enough usable views for a solution."""

    number = 603
    text = "Too few usable views"
    cause = "Too few images were taken, or the board was not found in most of them."
    remedy = "Take at least 20 views, near and far, tilted about both axes, up to all corners."


class MixedImageSizes(CalibrationError):
    """The images of one calibration differ in size."""

    number = 604
    text = "Images differ in size"
    cause = "Images of different cameras or resolutions were mixed, or one was cropped."
    remedy = "Use images at full resolution from this head only."


class CalibrationCamerasSwapped(CalibrationError):
    """The solution puts the right camera left of the left one."""

    number = 605
    text = "Left and right images are exchanged"
    cause = (
        "The two cameras or the two groups of files were given in the wrong order, or both cameras "
        "mirror their image, which a chessboard cannot tell."
    )
    remedy = "Look whether print in an image reads backwards. If not, exchange left and right."


class CalibrationCameraUpsideDown(CalibrationError):
    """One camera sees the board turned by about 180° against the other."""

    number = 606
    text = "One camera's image is upside down"
    cause = "The image is turned by 180° in the camera's settings, or the camera was remounted."
    remedy = "Give both cameras the same orientation and take the images again."


class PairsInconsistent(CalibrationError):
    """The pairs imply different poses of the right camera to the left one."""

    number = 607
    text = "Left and right images do not belong together"
    cause = "Pairs are mixed up, the board moved between two exposures, or a camera is loose."
    remedy = "Check that both groups of files have the same order; take the images again."


class CameraSeenTwice(CalibrationError):
    """The images of the right camera are those of the left one."""

    number = 608
    text = "Left and right images are the same"
    cause = "The same folder or files were given for both cameras."
    remedy = "Give the images of the left camera as left and those of the right camera as right."


class BoardMirrored(CalibrationError):
    """A board that has no mirror image of its own is seen as in a mirror."""

    number = 670
    text = "The camera mirrors its image"
    cause = "Mirroring is switched on in the camera's settings, or it looks over a mirror."
    remedy = "Switch it off for every camera of the head, and take the images again."


class KnownBoardDiffers(CalibrationError):
    """The file of a known board is that of another board."""

    number = 671
    text = "The known board is another one"
    cause = "The file belongs to a board of other corners or size, or the options are wrong."
    remedy = "Give the result of a calibration with this very board, or none."


class PoorCoverage(CalibrationError):
    """The views leave too much of the image, or of the needed directions, unseen."""

    number = 611
    text = "Views do not cover what the calibration needs"
    cause = "The board was always at the same place in the image or always at the same tilt."
    remedy = "Add views at the image borders and with tilts of 15–30° about both board axes."


class IllConditioned(CalibrationError):
    """The data determine some parameter not at all."""

    number = 612
    text = "The data do not determine the result"
    cause = "Motions or positions that are too small, too similar, or all in one direction."
    remedy = "See the detail for what is missing; take additional data."


class SolveFailed(CalibrationError):
    """The adjustment did not converge."""

    number = 613
    text = "The adjustment did not converge"
    cause = "Gross errors in the data, or data that belong to another setup."
    remedy = "Look at the residuals; remove wrong data or take it again."


class ResultOutOfLimits(CalibrationError):
    """A calibration was solved, but a figure of it is beyond its limit."""

    number = 614
    text = "Calibration result is out of its limits"
    cause = "Noise, movement, a damaged board, or too little data."
    remedy = "See the figures in the detail and the picture; repeat the calibration."


class MeasuredBeyondBound(CalibrationError):
    """A good measurement exceeds an upper bound that recipe or settings state."""

    number = 615
    text = "A measurement is beyond the bound of the recipe"
    cause = "The arm stops later or is stiffer than stated; or this PC was busy while it measured."
    remedy = (
        "See the figure in the detail. Find what has changed, or state a greater bound and lower "
        "the speeds that rest on it; then measure again. Until then production does not start."
    )


class AxisMotionInvalid(CalibrationError):
    """The stops of an axis are not a turn of that axis alone."""

    number = 621
    text = "Recorded stops are not a turn of one robot axis"
    cause = "Another axis moved too, targets were confused, or too few stops were taken."
    remedy = "Turn one axis alone, by at least 90°, and keep the targets in view."


class BoardPoseInvalid(CalibrationError):
    """Measured discs do not fit the drawing of the target board."""

    number = 622
    text = "Measured target board does not fit its drawing"
    cause = "Too few discs in view, wrong names, another board, or it moved while measured."
    remedy = "Look at the residuals of the discs; check board, light and view."


class PosesNotDiverse(CalibrationError):
    """Robot poses are too few or too alike."""

    number = 623
    text = "Robot poses are too few or too similar"
    cause = "Hand-eye and tool calibrations need turns about at least two directions."
    remedy = "Add poses that turn the flange by 20–60° about different axes."


class RobotCameraMismatch(CalibrationError):
    """Robot and camera report motions that cannot belong together."""

    number = 624
    text = "Robot and camera motions do not fit each other"
    cause = (
        "Wrong setup (eye-in-hand or eye-to-hand), inverted poses, angle convention or unit, or "
        "mixed-up poses."
    )
    remedy = (
        "Check that poses are base_T_flange and camera_T_board and not their inverses; then the "
        "setup, the pose convention, mm and degrees, and the order of the poses."
    )


class CalibrationRecordInvalid(CalibrationError):
    """A stored calibration cannot be read or was altered."""

    number = 631
    text = "Stored calibration cannot be used"
    cause = "The file is missing, incomplete, or its content does not match its identity."
    remedy = "Calibrate again in Maintenance mode; never edit these files."


class CalibrationMissing(CalibrationError):
    """A calibration that production needs is not in the set."""

    number = 632
    text = "A needed calibration is missing"
    cause = "It was never made for this cell, or its result was not accepted."
    remedy = "Run the calibration named in the detail in Maintenance mode."


class CalibrationExpired(CalibrationError):
    """A calibration is past its date."""

    number = 633
    text = "A needed calibration is no longer valid"
    cause = "Its validity has ended, or would end during the run."
    remedy = "Run the calibration named in the detail in Maintenance mode."


class CalibrationNotStored(CalibrationError):
    """A calibration, or word that one is invalid, did not reach the disk."""

    number = 634
    text = "Calibration could not be stored"
    cause = "calibration_dir is read-only, belongs to somebody else, or its disk is full."
    remedy = (
        "Give the daemon's user a calibration_dir that it may write, such as "
        "/var/lib/cellctl/calibration; restart the daemon and repeat the procedure."
    )


class CalibrationInvalidated(CalibrationError):
    """An event has made a calibration worthless before its date."""

    number = 635
    text = "A calibration was invalidated"
    cause = "The event in the detail may have moved what was calibrated."
    remedy = "Look at what happened; then run the calibration in Maintenance mode."


class ClockNotTrusted(CalibrationError):
    """The clock of the PC is behind something that it has stamped before."""

    number = 636
    text = "Clock of the PC cannot be trusted"
    cause = "The clock was set back, or it was ahead when the record in the detail was written."
    remedy = "Set the clock, see that it is synchronised, and start again."


class CalibrationOfOldForm(CalibrationError):
    """A stored calibration is of the form whose dates anybody could change."""

    number = 638
    text = "Stored calibration is of an earlier version"
    cause = "Its file protects the record alone, not its dates and its serial number."
    remedy = (
        "Compare dates and serial numbers with your own papers, then run "
        "`cellctl calibrate seal --by NAME`; or calibrate again in Maintenance mode."
    )


class HeadPoseChanged(CalibrationError):
    """A head's measuring pose is not the one at which it was calibrated."""

    number = 637
    text = "A head measures from another pose than it was calibrated at"
    cause = "The measuring pose in the cell file was taught anew after procedures 104 and 105."
    remedy = "Restore the joints in the detail, or run procedures 104 and 105."


class WristConfigurationsDiffer(CalibrationError):
    """Poses were reached with the arm or the wrist folded in different ways."""

    number = 564
    text = "Robot poses of different wrist configurations are mixed"
    cause = "A joint that says how the arm is folded has another sign in one of the poses."
    remedy = "Reach all poses in one configuration; see the joint in the detail."
