"""The parts of a proof bundle that are rows of one table (docs/bundle.md)."""

from __future__ import annotations

from assur.planner.claim import columns as c
from assur.planner.claim.fields import JOINTS, Field

STATES = (("q", c.KNOT_Q), ("qd", c.KNOT_QD), ("qdd", c.KNOT_QDD))
LINK = (
    Field("offset", c.LINK_OFFSET, count=3),
    Field("coupler", c.LINK_COUPLER, "whole"),
)
SLIDE = (Field("joint", c.LINK_SLIDE, "whole"), Field("axis", c.LINK_AXIS, count=3))
TURNS = (("yaw", c.LINK_YAW), ("pitch", c.LINK_PITCH), ("roll", c.LINK_ROLL))
LOOP = (
    Field("lengths", c.LOOP_LENGTH, count=2),
    Field("couplers", c.LOOP_COUPLER, count=2),
    Field("side", c.LOOP_SIDE),
    Field("least", c.LOOP_LEAST),
)
FRAME = (
    Field("arm", c.FRAME_ARM, "whole"),
    Field("pose", c.FRAME_POSE, count=4),
    Field("rate", c.FRAME_RATE, count=4),
    Field("shift", c.FRAME_SHIFT, count=2),
    Field("yaw", c.FRAME_YAW),
    Field("period", c.FRAME_PERIOD),
    Field("step", c.FRAME_STEP, count=4),
)
WAVE = (
    Field("coordinate", c.WAVE_COORDINATE, "whole"),
    Field("amplitude", c.WAVE_AMPLITUDE),
    Field("rate", c.WAVE_RATE),
    Field("phase", c.WAVE_PHASE),
)
DISPLACED = (
    Field("direction", c.DISPLACED_DIRECTION, count=3, empty=(c.DISPLACED_LEVEL, 1.0)),
    Field("amount", c.DISPLACED_AMOUNT),
    Field("growth", c.DISPLACED_GROWTH),
    Field("shared", c.DISPLACED_SHARED, "flag"),
)
PIECE = (
    Field("centre", c.PIECE_CENTRE, count=3),
    Field("axis", c.PIECE_AXIS, count=3),
    Field("disc", c.PIECE_DISC),
    Field("ball", c.PIECE_BALL),
)
SEAT = (
    Field("body", c.SEAT_BODY, "whole"),
    Field("link", c.SEAT_LINK, "whole"),
    Field("frame", c.SEAT_FRAME, "whole"),
    Field("pose", c.SEAT_POSE, count=4),
)
PHASE = (
    Field("t0", c.PHASE_T0),
    Field("t1", c.PHASE_T1),
    Field("near", c.PHASE_NEAR, "flag"),
    Field("robot", c.PHASE_ROBOT, "flag"),
)
CONTACT = (Field("bodies", c.CONTACT_BODY, "whole", 2), Field("depth", c.CONTACT_DEPTH))
RULE = (Field("travel", c.RULE_TRAVEL), Field("near", c.RULE_NEAR))
REQUIRED = (
    Field("travel", c.REQUIRED_TRAVEL),
    Field("near", c.REQUIRED_NEAR),
    Field("until", c.REQUIRED_UNTIL),
    Field("late", c.REQUIRED_LATE),
    Field("since", c.REQUIRED_SINCE),
    Field("tool_from", c.REQUIRED_TOOL, "whole"),
    Field("lag", c.REQUIRED_LAG, count=JOINTS),
    Field("nearest", c.REQUIRED_NEAREST),
    Field("placed", c.REQUIRED_PLACED),
)
LIMIT = (
    Field("t0", c.LIMIT_T0),
    Field("t1", c.LIMIT_T1),
    Field("shares", c.LIMIT_SHARE, count=4),
    Field("lower", c.LIMIT_LOWER, count=JOINTS),
    Field("upper", c.LIMIT_UPPER, count=JOINTS),
    Field("velocity", c.LIMIT_VELOCITY, count=JOINTS),
    Field("acceleration", c.LIMIT_ACCELERATION, count=JOINTS),
    Field("jerk", c.LIMIT_JERK, count=JOINTS, empty=(c.LIMIT_JERKS, 0.0)),
)
POINT = (
    Field("t0", c.POINT_T0),
    Field("t1", c.POINT_T1),
    Field("frame", c.POINT_FRAME, "whole"),
    Field("link", c.POINT_LINK, "whole"),
    Field("tool", c.POINT_TOOL, count=4),
    Field("target", c.POINT_TARGET, count=4),
    Field("middle", c.POINT_MIDDLE),
    Field("height", c.POINT_HEIGHT, count=1, open=True),
    Field("position", c.POINT_POSITION),
    Field("yaw", c.POINT_YAW, count=1, open=True),
    Field("rates", c.POINT_RATE, count=2, open=True),
)
RATE = (
    Field("t0", c.RATE_T0),
    Field("t1", c.RATE_T1),
    Field("link", c.RATE_LINK, "whole"),
    Field("point", c.RATE_POINT, count=3),
    Field("frame", c.RATE_FRAME, "whole"),
    Field("order", c.RATE_ORDER, "whole"),
    Field("least", c.RATE_LEAST),
    Field("most", c.RATE_MOST),
)
AXIS = (
    Field("t0", c.AXIS_T0),
    Field("t1", c.AXIS_T1),
    Field("link", c.AXIS_LINK, "whole"),
    Field("place", c.AXIS_PLACE, "flag"),
    Field("axis", c.AXIS_ON, count=3),
    Field("other", c.AXIS_OTHER, "whole"),
    Field("direction", c.AXIS_DIRECTION, count=3),
    Field("low", c.AXIS_LOW),
    Field("high", c.AXIS_HIGH),
)
SUM = (
    Field("t0", c.SUM_T0),
    Field("t1", c.SUM_T1),
    Field("order", c.SUM_ORDER, "whole"),
    Field("joints", c.SUM_SHARE, count=JOINTS),
    Field("low", c.SUM_LOW),
    Field("high", c.SUM_HIGH),
)
GUIDE = (
    Field("t0", c.GUIDE_T0),
    Field("t1", c.GUIDE_T1),
    Field("link", c.GUIDE_LINK, "whole"),
    Field("tool", c.GUIDE_TOOL, count=3),
    Field("frames", c.GUIDE_FRAME, "whole", 2),
    Field("from", c.GUIDE_FROM, count=3),
    Field("to", c.GUIDE_TO, count=3),
    Field("shares", c.GUIDE_SHARE, count=2),
    Field("most", c.GUIDE_MOST),
)
DISTANCE = (
    Field("time", c.DISTANCE_TIME),
    Field("phase", c.DISTANCE_PHASE, "whole"),
    Field("bodies", c.DISTANCE_BODY, "whole", 2),
    Field("pieces", c.DISTANCE_PIECE, "whole", 2),
    Field("most", c.DISTANCE_MOST),
    Field("weights", c.DISTANCE_WEIGHT, count=4),
    Field("directions", c.DISTANCE_DIRECTION, count=12),
)
ERROR = (
    Field("time", c.ERROR_TIME),
    Field("phase", c.ERROR_PHASE, "whole"),
    Field("frame", c.ERROR_FRAME, "whole"),
    Field("link", c.ERROR_LINK, "whole"),
    Field("tool", c.ERROR_TOOL, count=4),
    Field("target", c.ERROR_TARGET, count=4),
    Field("off", c.ERROR_OFF, count=3),
    Field("arm", c.ERROR_ARM),
    Field("distance", c.ERROR_FAR),
    Field("horizontal", c.ERROR_FLAT),
    Field("vertical", c.ERROR_UP),
    Field("yaw", c.ERROR_YAW),
)
ROW = (
    Field("t0", c.ROW_T0),
    Field("t1", c.ROW_T1),
    Field("s0", c.ROW_S0),
    Field("s1", c.ROW_S1),
    Field("bodies", c.ROW_BODY, "whole", 2),
    Field("pieces", c.ROW_PIECE, "whole", 2),
    Field("normal", c.ROW_NORMAL, count=3),
)

SECTIONS = {
    "seats": SEAT,
    "limits": LIMIT,
    "points": POINT,
    "rates": RATE,
    "axes": AXIS,
    "sums": SUM,
    "guides": GUIDE,
    "distances": DISTANCE,
    "errors": ERROR,
    "rows": ROW,
    "gap_rows": ROW,
}
"""The parts of a bundle that are a table, object by row."""
NAMED = ("points", "rates", "axes")
"""Those whose objects have a name."""
