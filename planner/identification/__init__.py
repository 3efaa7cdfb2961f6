"""Limits of joints, found in recorded motion: S-curves behind a servo's lag are fitted to the moves between rests."""

from assur.planner.identification.recording import JointRecord, fault_of_times
from assur.planner.identification.verdict import Estimate, JointLimits, Reason, Status, joint_limits

__all__ = ["Estimate", "JointLimits", "JointRecord", "Reason", "Status", "fault_of_times", "joint_limits"]
