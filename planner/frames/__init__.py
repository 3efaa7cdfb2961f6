"""Frames of a cell: poses, motions, and the time laws by which frames move."""

from assur.planner.frames.conveyor import Conveyor
from assur.planner.frames.fixed import Fixed, Linear, all_stand
from assur.planner.frames.heading import constant_yaw
from assur.planner.frames.indexer import Indexer
from assur.planner.frames.keyframes import Keyframes
from assur.planner.frames.law import Frame, Law, PoseUncertainty, Uncertainty
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.oscillation import Oscillation
from assur.planner.frames.ramps import Change
from assur.planner.frames.swing import Swing
from assur.planner.frames.turntable import Turntable
from assur.planner.frames.validity import ALWAYS

__all__ = [
    "ALWAYS",
    "Change",
    "Conveyor",
    "Fixed",
    "Frame",
    "Indexer",
    "Keyframes",
    "Law",
    "Linear",
    "Motion",
    "Oscillation",
    "Pose",
    "PoseUncertainty",
    "Swing",
    "Turntable",
    "Uncertainty",
    "all_stand",
    "constant_yaw",
]
