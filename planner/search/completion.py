"""Makes a plan of a whole partial and has it checked: nothing is an answer that the checker refuses."""

from __future__ import annotations

from assur.planner.checked import check
from assur.planner.collision.rows import written
from assur.planner.errors import FaultError
from assur.planner.model.deadline import look
from assur.planner.model.outcome import Plan
from assur.planner.model.refusal import Reason, Refusal, Refuted, Stage
from assur.planner.model.scene import Scene
from assur.planner.search.partial_plan import PartialPlan
from assur.planner.trajectory import Trajectory


def completed(scene: Scene, partial: PartialPlan) -> Plan | Refusal:
    """The plan of a partial through all steps, with its certificate; a refusal where the checker does not accept it.

    That is a fault of the planner. The census counts it under the stage `checker`, the sentence of a refusal begins
    with it, and each test and benchmark counts it as a failure. Raises `OutOfTimeError` where the deadline in force
    passes before the checker has accepted it.
    """
    if partial.knots is None:
        raise FaultError("a whole partial without knots")
    trajectory = Trajectory.of_knots(partial.knots.table, jumps=not scene.options.jerk_limited)
    certificate = written(scene, trajectory, partial.legs, partial.arrivals, list(partial.proofs))
    plan = Plan(trajectory, partial.legs, partial.arrivals, certificate)
    verdict = check(scene, plan, between=look)
    if verdict.ok:
        return plan
    first = verdict.findings[0]
    return Refusal(
        stage=Stage.CHECKER,
        reason=Reason.NOT_CERTIFIED,
        step=partial.step - 1,
        facts=Refuted(code=str(first.code), what=first.what, where=first.where),
    )
