"""The steps of one plugging in their order, with the numbers that the line and the record see."""

from cellctl.processes.antenna_module.state import GripperEmpty, Released
from cellctl.processes.antenna_module.steps.check_reference import check_reference
from cellctl.processes.antenna_module.steps.find_module import find_module
from cellctl.processes.antenna_module.steps.insert import insert
from cellctl.processes.antenna_module.steps.inspect_plug import inspect_plug
from cellctl.processes.antenna_module.steps.locate_socket import locate_socket
from cellctl.processes.antenna_module.steps.pick import pick
from cellctl.processes.antenna_module.steps.plan import plan
from cellctl.processes.antenna_module.steps.stand_off import stand_off
from cellctl.processes.antenna_module.steps.verify import verify
from cellctl.runtime.steps import Restart, Steps, StepSpec

CHECK_REFERENCE = StepSpec(10, "check reference", check_reference)
FIND_MODULE = StepSpec(20, "find module", find_module)
PICK = StepSpec(30, "pick", pick)
# From here on a module is in the gripper: the steps cannot begin again with it, so a Hold waits
# until the run has ended.
INSPECT_PLUG = StepSpec(40, "inspect plug", inspect_plug, restart=Restart.NO_WAY_BACK)
LOCATE_SOCKET = StepSpec(50, "locate socket", locate_socket, restart=Restart.NO_WAY_BACK)
PLAN = StepSpec(60, "plan", plan, restart=Restart.NO_WAY_BACK)
STAND_OFF = StepSpec(70, "stand-off", stand_off, restart=Restart.NO_WAY_BACK)
INSERT = StepSpec(80, "insert", insert, contact=True, restart=Restart.NO_WAY_BACK)
VERIFY = StepSpec(90, "verify", verify, contact=True, restart=Restart.NO_WAY_BACK)

PLUGGING: Steps[GripperEmpty, Released] = (
    Steps.first(CHECK_REFERENCE)
    .then(FIND_MODULE)
    .then(PICK)
    .then(INSPECT_PLUG)
    .then(LOCATE_SOCKET)
    .then(PLAN)
    .then(STAND_OFF)
    .then(INSERT)
    .then(VERIFY)
)
