"""Events of an executed action: what the robot's joints tell of its base, its hands and the held objects."""

from skolem.estimation import arm
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Event, Lost, Moved, Picked, PickFailed, Placed, Posed
from skolem.traces.messages import HANDS, Action, ActionResult, Hand, NoiseModel, Pick, Place, Pose4
from skolem.traces.messages.poses import raised


def events_of(
    action: Action,
    result: ActionResult,
    grasps: dict[Hand, tuple[str, Pose4]],
    noise: NoiseModel,
    config: EstimatorConfig,
    top_m: float | None = None,
) -> tuple[Event, ...]:
    """Return the effects of an action on the robot and its objects, in order.

    Args:
        action: The executed action.
        result: What the joints reported.
        grasps: Anchor and tool_T_object of each hand that held an object before the action.
        noise: Noise of the wheels, and of objects at release.
        config: Reads `closed_gap_m`, `height_tolerance_m`, and the sds of lost, dropped and touched objects.
        top_m: Believed height of the support's top for a place, metres; None if there is no support.

    A hand no longer holds its object once the fingers have met, whatever the action was. If the joints say that an
    object left the hand above or below the top, it does not stand on the top: it met something on the way, or met no
    top.

    An arm that touched something on a way that was believed free has neither closed nor opened its fingers. The base
    then stands elsewhere than believed. It is taken to be as uncertain as after a short drive, so that the robot looks
    again.
    """
    events: list[Event] = [Posed(robot=result.robot)]
    if result.odometry is not None:
        events += _drive(result.odometry, noise)
    if isinstance(action.command, Pick | Place) and result.base_T_tool is None:
        events.append(Moved(start_T_end=(0.0, 0.0, 0.0), sd_m=config.touched_sd_m, sd_rad=config.touched_sd_rad))
    lost = [
        loss for hand in HANDS if hand in grasps for loss in _lost(hand, grasps[hand], action, result, config, top_m)
    ]
    events += lost
    match action.command:
        case Pick():
            events += _pick(action, action.command, result, config)
        case Place() if action.command.hand in grasps.keys() - {loss.hand for loss in lost}:
            events += _place(action, action.command, result, grasps[action.command.hand], noise)
    return tuple(events)


def _lost(
    hand: Hand,
    grasp: tuple[str, Pose4],
    action: Action,
    result: ActionResult,
    config: EstimatorConfig,
    top_m: float | None,
) -> list[Lost]:
    """Return the loss of a hand's object, if its fingers have met or a place did not put it on the top.

    A place fails if the hand is empty or drops the object. Otherwise, fingers that are apart still hold the object,
    because a hand with opened fingers is believed to be empty.
    """
    anchor, tool_T_object = grasp
    gap = result.gaps_m.get(hand)
    is_empty = gap is not None and gap < config.closed_gap_m
    is_place = isinstance(action.command, Place) and action.command.hand == hand
    opened = result.base_T_tool if is_place else None
    missed = opened is not None and top_m is not None and _misses(opened[2] + tool_T_object[2], top_m, config)
    failed = opened is not None and result.status == "failed"
    if not is_empty and not failed and not missed:
        return []
    dropped = not is_empty and (missed or gap is not None)
    tool = arm.base_T_tool(result.robot, hand)
    here = raised(arm.flattened(tool), float(tool[2, 3]))
    return [
        Lost(
            hand=hand,
            anchor=anchor,
            base_T_tool=here if opened is None else opened,
            sd_m=config.dropped_sd_m if dropped else config.lost_sd_m,
            sd_rad=config.unknown_heading_sd_rad,
            sd_z_m=config.lost_sd_z_m,
        )
    ]


def _misses(felt_m: float, top_m: float, config: EstimatorConfig) -> bool:
    """Return whether an object does not rest on a top at `top_m` if its base was at `felt_m` (metres) at release."""
    return abs(felt_m - top_m) > config.height_tolerance_m


def _drive(start_T_end: tuple[float, float, float], noise: NoiseModel) -> list[Event]:
    """Return the motion of the base; nothing if the wheels did not turn."""
    x, y, turn = start_T_end
    distance = (x * x + y * y) ** 0.5
    if distance == 0.0 and turn == 0.0:
        return []
    sd_m = noise.odometry_sd_m + noise.odometry_sd_per_m * distance
    sd_rad = noise.odometry_sd_rad + noise.odometry_sd_per_rad * abs(turn)
    return [Moved(start_T_end=start_T_end, sd_m=sd_m, sd_rad=sd_rad)]


def _pick(action: Action, command: Pick, result: ActionResult, config: EstimatorConfig) -> list[Event]:
    """Return the success or failure of a grasp; nothing if the fingers did not close at all."""
    if result.base_T_tool is None or result.gripper_gap_m is None:
        return []
    anchor = action.args[0]
    if result.status == "failed" or result.gripper_gap_m < config.closed_gap_m:
        return [PickFailed(anchor=anchor)]
    pose, planned = result.base_T_tool, command.tool_T_object
    return [Picked(hand=command.hand, anchor=anchor, base_T_tool=pose, tool_T_object=planned)]


def _place(
    action: Action,
    command: Place,
    result: ActionResult,
    grasp: tuple[str, Pose4],
    noise: NoiseModel,
) -> list[Event]:
    """Return the release of an object; nothing if the fingers did not open."""
    if result.base_T_tool is None:
        return []
    anchor, tool_T_object = grasp
    return [
        Placed(
            hand=command.hand,
            anchor=anchor,
            base_T_tool=result.base_T_tool,
            tool_z_object=tool_T_object[2],
            support=action.args[1] if len(action.args) > 1 else None,
            sd_m=noise.place_sd_m,
            sd_rad=noise.place_sd_rad,
        )
    ]
