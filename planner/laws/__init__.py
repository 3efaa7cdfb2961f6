"""Laws of frames: how a frame moves in time, as polynomial pieces, sines and a period."""

from assur.planner.frames.motion import Motion, Pose
from assur.planner.laws.kinds import conveyor, fixed, indexer, keyframes, linear, oscillation, slowed, swing, turntable
from assur.planner.laws.law import (
    EXACT,
    ArmLink,
    Frame,
    Law,
    Numbers,
    PoseUncertainty,
    Uncertainty,
    all_stand,
    law_tables,
)
from assur.planner.laws.ramps import Change
from assur.planner.laws.validity import ALWAYS

__all__ = [
    "ALWAYS",
    "EXACT",
    "ArmLink",
    "Change",
    "Frame",
    "Law",
    "Motion",
    "Numbers",
    "Pose",
    "PoseUncertainty",
    "Uncertainty",
    "all_stand",
    "conveyor",
    "fixed",
    "indexer",
    "keyframes",
    "law_tables",
    "linear",
    "oscillation",
    "slowed",
    "swing",
    "turntable",
]
