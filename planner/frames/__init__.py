"""Frames of a cell: poses, motions, and the time laws by which frames move."""

from planner.frames.conveyor import Conveyor
from planner.frames.fixed import Fixed, Linear, all_stand
from planner.frames.indexer import Indexer
from planner.frames.keyframes import Keyframes
from planner.frames.law import Frame, Law, LawBounds, Uncertainty
from planner.frames.motion import Motion, Pose
from planner.frames.ramps import Change
from planner.frames.swing import Swing
from planner.frames.turntable import Turntable
from planner.frames.validity import ALWAYS

__all__ = [
    "ALWAYS",
    "Change",
    "Conveyor",
    "Fixed",
    "Frame",
    "Indexer",
    "Keyframes",
    "Law",
    "LawBounds",
    "Linear",
    "Motion",
    "Pose",
    "Swing",
    "Turntable",
    "Uncertainty",
    "all_stand",
]
