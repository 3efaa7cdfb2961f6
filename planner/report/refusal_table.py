"""Everything about refusals that depends on the kind of their facts, as one table: reasons, subject, units, sentences.

A sentence is a template. `{name}` is a fact, another word that `refusal_words` computes, or a part in `PARTS`. What is
in [] is left out unless all its words are known. The first sentence is used whose words are all known, and whose codes
(stage, reason, obstacle, and the like) the refusal has. The place on a path, where there is one, is put before it
(`on_path`); `{path}` is empty, and known where there is one.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import assur.planner.model.refusal as r
from assur.planner.model.refusal import Obstacle, Reason, Stage
from assur.planner.model.window_missed import Miss, WindowMissed

Row = str | tuple[str, ...]
"""A template; or a template, and the codes that a refusal must have for it."""


class Kind(NamedTuple):
    """What holds of refusals with facts of one kind. `about`: the subject that it may have ("nothing": it may have
    none); `units`: of its amount, if it has one."""

    reasons: tuple[Reason, ...]
    about: tuple[Literal["nothing", "body", "pair", "joint", "frame"], ...]
    units: tuple[r.Unit, ...]


MODE = "[ (mode {mode})]"
MORE = "a contact_tolerance_mm of the step allows more"
COLLISIONS = (
    Reason.SELF_COLLISION,
    Reason.BODY_COLLISION,
    Reason.START_IN_COLLISION,
    Reason.CONTROL_POINT_IN_COLLISION,
    Reason.NOT_CERTIFIED,
)

KINDS = {
    r.OutOfReach: Kind((Reason.OUT_OF_REACH,), ("nothing",), ("m",)),
    r.BeyondRange: Kind((Reason.JOINT_LIMIT,), ("joint",), ("m", "rad")),
    r.Singular: Kind((Reason.NEAR_SINGULARITY, Reason.NEAR_PARALLEL_SINGULARITY), ("nothing",), ("1", "m")),
    r.MotionLimit: Kind(
        (Reason.MOTION_LIMIT,),
        ("joint", "frame", "nothing"),
        ("1", "rad/s", "rad/s²", "rad/s³", "m/s", "m/s²", "m/s³"),
    ),
    r.Overshoot: Kind((Reason.JOINT_LIMIT, Reason.MOTION_LIMIT), ("joint",), ("rad", "m", "rad/s", "m/s")),
    r.AccelerationTime: Kind((Reason.MOTION_LIMIT,), ("joint",), ("rad/s²", "m/s²")),
    r.Separation: Kind(COLLISIONS, ("pair",), ("m",)),
    r.Enclosed: Kind(COLLISIONS, ("pair",), ("m",)),
    r.Carrying: Kind((Reason.CARRY_LIMIT,), ("nothing",), ("m/s²",)),
    r.Corrected: Kind((Reason.JOINT_LIMIT, Reason.NEAR_SINGULARITY), ("joint", "nothing"), ("m", "rad")),
    r.ForbiddenYaw: Kind((Reason.FORBIDDEN_YAW,), ("nothing",), ("rad",)),
    r.Inaccurate: Kind((Reason.TOLERANCE,), ("nothing",), ("m", "rad")),
    r.NotTouching: Kind((Reason.TOLERANCE,), ("pair",), ("m",)),
    r.Overload: Kind((Reason.LOAD_LIMIT,), ("body", "nothing"), ("kg", "kg·m²")),
    WindowMissed: Kind((Reason.WINDOW_MISSED,), ("nothing",), ("s", "m")),
    r.LawEnds: Kind((Reason.LAW_ENDS,), ("frame", "nothing"), ("s",)),
    r.Refuted: Kind((Reason.NOT_CERTIFIED,), ("nothing",), ()),
}
"""What holds of refusals with facts of each kind, by their types."""

SENTENCES: dict[type, tuple[Row, ...]] = {
    r.OutOfReach: (
        "a straight leg cannot change from mode {modes_0} to {modes_1}, and its line leaves the workspace",
        "{out_of_reach} at every pitch of the tool{every_pitch}",
        "{out_of_reach}: the flange would have to be at a height of {heights_m_0}, but it stays at {heights_m_1}",
        (
            "{out_of_reach}: the flange would be {from_axis_m} from the arm's axis[, with the tool at a "
            "pitch of {pitch_rad}]"
        ),
        ("{out_of_reach}" + MODE, Stage.CONTROL_POINT),
        ("{path}the path of the tool leaves the reach of the arm[; from there on it is up to {short} out of reach]"),
        ("the straight line leaves the workspace", Stage.STRAIGHT),
        ("the point leaves the workspace while it is tracked", Stage.TRACKING),
        ("the point is out of reach when the arm could be there", Stage.TIMING),
        ("the point stays at least {short} out of reach at all times at which it may be met" + MODE, Stage.INVERSE),
        "{out_of_reach}" + MODE,
    ),
    r.BeyondRange: (
        ("{joint} starts at {value}, {beyond}", Stage.START),
        "{path}{joint} leaves its range; from there on it would have to go up to {value}, {beyond}",
        ("{joint} starts [{short} ]beyond its limit", Stage.START),
        "[{arch}, ][{above_m} above the point, ]{joint} would have to go to {value}, {beyond}" + MODE,
        "[{arch}, ][{above_m} above the point, ]{joint} would have to go [{short} ]beyond its limit" + MODE,
    ),
    r.Singular: (
        (
            "a straight leg cannot change from mode {modes_0} to {modes_1}: its line comes no closer than "
            "{distance_m} to a singular position"
        ),
        (
            "the arm would cross a position in which its motors do not hold the tool (type 2 singularity)"
            "{crossed}[: parallel {margins}]",
            Reason.NEAR_PARALLEL_SINGULARITY,
        ),
        (
            "the arm would be too close to a position in which its motors do not hold the tool[ (parallel {margins})]",
            Reason.NEAR_PARALLEL_SINGULARITY,
        ),
        "the straight line comes within {distance_m} of a singular position ([{names}; ]singularity {margins})",
        "the straight line comes within {distance_m} of a singular position",
        "{positions}" + MODE,
        (
            "{path}the arm comes too close to a singular position; from there on the singularity margin is "
            "{margin} at the least, required {required}"
        ),
        "the arm would be too close to a singular position[ (singularity {margins})]",
    ),
    r.MotionLimit: (
        ("the joints cannot follow the path: its motion is not smooth", Obstacle.NOT_SMOOTH),
        ("no motion along the straight line was found that keeps the limits of all joints", Obstacle.NO_PATH_LAW),
        ("no motion was found that keeps the limits of all joints", Obstacle.NO_PROFILE),
        ("no motion was found that takes exactly the time to a meeting", Obstacle.NO_SUCH_DURATION),
        ("the lift would go down before the top of the arch, or up after it", Obstacle.NO_ARCH),
        ("the arm would stop at the point before, which is to be flown by", Obstacle.STOPS_AT_VIA),
        ("a straight leg must begin at rest or while a frame is tracked", Obstacle.STRAIGHT_FROM_MOTION),
        ("the control point moves too fast to be met", Obstacle.POINT_TOO_FAST),
        (
            "a leg along a path must begin and end in the same frame, or in frames that stand still",
            Obstacle.OTHER_FRAME,
        ),
        ("a leg along a path cannot change the working mode", Obstacle.OTHER_MODE),
        (
            "from where the leg begins there is no such path: points coincide, lie on a line, or turn back",
            Obstacle.NO_PATH,
        ),
        (
            "the joints cannot follow the path within 0.01 mm and 1 % of its speed: it bends too much",
            Obstacle.PROCESS_SPEED,
        ),
        ("the {rate} of {joint} at the start is {value}, but its limit is {limit}", Stage.START),
        ("the {rate} of {joint} at the start exceeds its limit[ by {short}]", Stage.START),
        "[{to_do}, ]{joint} would need a {rate} of {value}, but its limit is {limit}" + MODE,
        "[{to_do}, ]{joint} would have to exceed its limit of {rate}[ by {short}]" + MODE,
    ),
    r.Overshoot: (
        (
            "{joint} accelerates at the start, and however fast the acceleration falls, the velocity reaches "
            "{value} {after_s} after the start[, {short} too much]; its limit is {limit}",
            "velocity",
        ),
        (
            "{joint} moves towards the end of its range at {limit} too fast to stop there: however hard it brakes, "
            "it reaches {value} {after_s} after the start[, {short} too much]"
        ),
        "{joint} exceeds a limit after the start, however hard it brakes",
    ),
    r.AccelerationTime: (
        (
            "with an acceleration time of {given_s} {joint} would need {needed}, but it has {limit}[; {enough_s} "
            "would be enough]"
        ),
        "with an acceleration time of {given_s} {joint} would exceed its acceleration",
    ),
    r.Separation: (
        (
            "{first} and {second} could not be proved to be pressed together by no more than {allowed}: " + MORE,
            Reason.NOT_CERTIFIED,
            "contact",
        ),
        ("{first} and {second} could not be proved to stay apart", Reason.NOT_CERTIFIED),
        "{end} is too short: {straight_m} above the point {near}[; it must be at least {enough}]",
        "[{beginning}]{near}[; if {resting} is to rest on {other}, name it in contact_with]",
    ),
    r.Enclosed: (("[{beginning}]{first} is inside {second}"),),
    r.Carrying: (("the part would be accelerated with {acceleration} m/s², but only {limit} m/s² are allowed"),),
    r.Corrected: (
        (
            "the belt correction may shift the tool by {shift_m}, which would bring {joint} beyond its range",
            Reason.JOINT_LIMIT,
        ),
        "the belt correction may shift the tool by {shift_m}, which would bring the arm to a singular position",
    ),
    r.ForbiddenYaw: (
        ("the yaw of the tool at the start is {yaw_rad}, in the forbidden range {range}{deep}", Stage.START),
        (
            "to a yaw of {yaw_rad} the tool would have to turn through the forbidden range {range}{on_the_way}" + MODE,
            Stage.INVERSE,
        ),
        "on its way the tool would turn into the forbidden range of yaw {range}[, by {short}]{on_the_way}",
        "the yaw of the tool would be {yaw_rad}, in the forbidden range {range}{deep}" + MODE,
    ),
    r.Inaccurate: (
        ("the tool may be {position_m} off, but only {allowed_m} are allowed; {cause_of_most}", "m"),
        ("the tool may be {yaw_rad} off, but only {allowed_rad} are allowed; {cause_of_most}", "rad"),
        "the tool may be farther off than is allowed, most of it due to: {cause}",
    ),
    r.NotTouching: (
        ("the tool would be too far from {second} when it takes it: {first}, its nearest body, {far}", "grip"),
        "{first} would be too far from what it is put down on: {second}, the nearest, {far}",
    ),
    r.Overload: (
        (
            "{load}, but the maximum load of {robot} is {limit}; {lighter}a lighter tool or a robot for this load "
            "would help",
            "max_load",
        ),
        (
            "{load}, but acceleration_by_load ends at {limit}; {lighter}a lighter tool or a row for this mass "
            "would help",
            "table",
        ),
        (
            "{load}, but the maximum of {robot} is {limit}; {lighter}a tool that is lighter or nearer to the axis "
            "or a robot for this load would help",
            "max_inertia",
        ),
        "the robot may not carry so much",
    ),
    WindowMissed: (
        "the arm comes [at least {short} ]too late for latest_end_s{late}",
        (
            "the {what} must be tracked for {needed_s}, but its window is open for only {open_s}{soon}"
            "[ ({short} short{belt})]",
            Miss.TOO_SHORT,
        ),
        ("the window closes [{short} ]before the start", Miss.OVER_BEFORE_START),
        ("the window opens [{short} ]after latest_end_s", Miss.OPENS_AFTER_LATEST_END),
        ("latest_end_s is [{short} ]before the start", Miss.LATEST_END_BEFORE_START),
        ("the point enters its window [{short} ]after latest_end_s", Miss.ENTERS_AFTER_LATEST_END),
        (
            "the point never enters its window along the conveyor: it stays [{short} ]away"
            "[, and the conveyor carries it farther away, at {carried} mm/s]",
            Miss.NEVER_INSIDE,
        ),
        (
            "the window in time and the window along the conveyor never overlap: they are [{short} ]apart",
            Miss.NO_COMMON_INSTANT,
        ),
        ("the window opens when the motion of the frame is no longer known", Miss.OPENS_AFTER_LAW),
        ("the point does not enter its window while the motion of its frame is known", Miss.NOT_INSIDE_WHILE_KNOWN),
        ("the point does not enter its window{soon}", Miss.NOT_INSIDE_SOON),
        ("the arm comes [at least {short} ]after the window has closed{belt}", Miss.CLOSED_ON_ARRIVAL),
        ("the arm comes [at least {short} ]too late to end by latest_end_s{belt}", Miss.LATEST_END_ON_ARRIVAL),
        ("the motion ends [at least {short} ]after latest_end_s", Miss.ENDS_TOO_LATE),
        ("the arm comes [at least {short} ]too late {closing}", Miss.NO_MEETING_LEFT),
        ("the point would be met [{short} ]outside its window", Miss.OUTSIDE),
        ("no start of the motion was found from which all windows are met", Miss.NO_COMMON_BEGIN),
        "the point is not met in its window",
    ),
    r.LawEnds: (
        "{law}, but the point cannot be met before {needed}{at_once}{sooner}",
        ("{law}, but it is needed until {needed}: the point must be tracked for {tracked_s}, from {begin} on{sooner}"),
        "{law}, but it is needed at {needed}",
        "the motion of a frame is not known at {needed}",
    ),
    r.Refuted: (("the checker refuses the plan: {code}, {what}[, {where}]"),),
}
"""The sentences of each kind."""

APART = "[: {distance}[ ({clearance})]]"
PARTS: dict[str, tuple[Row, ...]] = {
    "place": ("at {at} mm[ in {target}], ",),
    "on_path": (
        ("on the lead-in, {before} before the path begins, {place}", "lead-in"),
        ("on the lead-out[, {behind} behind the end of the path], {place}", "lead-out"),
        "{path_m} along the path, {place}",
    ),
    "out_of_reach": ("the point is [{short} ]out of reach",),
    "beyond": ("[{short} ]beyond the end of its range at {limit}",),
    "arch": ("for an arch up to {arch_top_m}[ (the lift allows {arch_most})]",),
    "margins": ("margin {margin}, required {required}",),
    "to_do": (
        ("to go along the path at {speed_m_s}", Obstacle.PATH_TOO_FAST),
        ("to go along the path at the process speed", Obstacle.PATH_TOO_FAST),
        ("to move with {frame}", Obstacle.FRAME_TOO_FAST),
    ),
    "beginning": (
        ("the arm would hit itself: ", Reason.SELF_COLLISION),
        ("the arm collides at the start: ", Reason.START_IN_COLLISION),
        ("the control point cannot be met without a collision: ", Reason.CONTROL_POINT_IN_COLLISION),
    ),
    "distance": (
        "they would overlap by up to {overlap}, and the required distance is {required}",
        "gap {gap}, required {required}{alike}",
    ),
    "clearance": (
        ("clearance near a point {clearance_m}[, uncertainty {unknown}]", "near"),
        ("clearance in travel {clearance_m}[, uncertainty {unknown}]", "travel"),
        ("clearance of the exception {clearance_m}[, uncertainty {unknown}]", "exception"),
    ),
    "near": (
        (
            "{first} would be pressed {pressed} into {second}[ (uncertainty {unknown})], but only {allowed} is allowed"
            "{alike}: " + MORE
        ),
        "{first} would hit {second}{touching}" + APART,
        "{first} would come too close to {second}" + APART,
    ),
    "range": ("from {first_rad} to {last_rad}[ ({lag_rad} wider at both ends, for joints that lag)]",),
    "deep": ("[, {short} beyond its nearer end]",),
    "far": ("is {distance_m} away, and at most {allowed_m} is allowed",),
    "cause_of_most": ("most of it, {most}, is due to: {cause}",),
    "axis": (("[ about {last_joint}]", "max_inertia"), ""),
    "load": (
        ("tool and {part} have {value}{axis} together[ ({tool} and {part_value})] from the start on", Stage.START),
        "tool and {part} have {value}{axis} together[ ({tool} and {part_value})] from here on",
        "the tool has {value}{axis}",
    ),
    "lighter": ("[a part of up to {spare}, ]",),
    "soon": ("[ in the next {searched_s}]",),
    "belt": ("[, {belt_m} of belt]",),
    "law": ("the motion of {frame} is known {known}",),
    "sooner": ("[; the arm cannot be there sooner{on_arrival}]",),
}
"""What several sentences have in common."""
