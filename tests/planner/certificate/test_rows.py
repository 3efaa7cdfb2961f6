"""The certificate that is written from the proofs of all phases."""

from __future__ import annotations

import numpy as np

from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import Rows, written
from assur.planner.kernels.proof import ALONG, OTHER, T0, T1, UNIT
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Planned
from assur.planner.model.phases import phases
from assur.planner.pipeline import plan
from tests.planner.cells import belt_and_dial, go
from tests.planner.second_solids import carriers, gaps, place, standing, units_of


def test_rows_of_all_phases_are_written_with_the_names_and_pieces_of_their_bodies() -> None:
    scene = belt_and_dial(go(0.35, 0.0, 0.12))
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    made, prover = outcome.plan, Prover(scene)
    proofs = []
    for phase in phases(scene, made.legs, made.arrivals):
        rows = prover.prove(phase, made.trajectory)
        assert isinstance(rows, Rows)
        proofs.append(rows)
    certificate = written(scene, made.trajectory, made.legs, made.arrivals, proofs)
    assert certificate.digest == digest(scene.digest, made.trajectory, made.legs, made.arrivals, certificate)
    assert len(certificate) == sum(len(rows) for rows in proofs)
    assert len(set(certificate.names)) == len(certificate.names)
    # the gap of each row, of the bodies that its names mean in its phase
    first = 0
    for rows in proofs:
        part = slice(first, first + len(rows))
        first += len(rows)
        named = [certificate.names[i] for i in certificate.first[part]]
        assert named == [rows.arrangement.names[rows.arrangement.body[unit]] for unit in units_of(rows, UNIT)]
        assert np.array_equal(certificate.second_piece[part], rows.arrangement.piece[units_of(rows, OTHER)])
        normal = rows.table[:, None, ALONG : ALONG + 3]
        for t in (rows.table[:, T0], rows.table[:, T1]):
            where = carriers(scene, standing(made.trajectory, t), t)
            row = np.arange(len(t))
            one, other = (
                place(rows.arrangement, where, row, unit) for unit in (units_of(rows, UNIT), units_of(rows, OTHER))
            )
            # parts that are picked and placed may touch what they rest on, by a tenth of a millimetre
            assert gaps(one, other, normal).min() >= -1e-4


def test_the_part_is_one_name_whether_it_is_carried_or_not() -> None:
    scene = belt_and_dial(go(0.35, 0.0, 0.12))
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    certificate = outcome.plan.certificate
    part = certificate.names.index("part")
    assert (certificate.first == part).any()
    assert (certificate.second == part).any()
