"""The addresses of simulations: each is a job, of a cell that is kept or of one in the body."""

from __future__ import annotations

from typing import Any

from fastapi import Request
from starlette.responses import Response

from assur.api.problems import Problem
from assur.api.web.clients import client_of
from assur.api.web.job_routes import accepted
from assur.api.web.mesh_routes import digest_of, folder_of
from assur.api.web.openapi import fields, ref
from assur.api.web.routes import once, read_admitted, service_of
from assur.api.web.settings import PLAN_BODY_BYTES
from assur.api.workers import cell_jobs
from assur.api.workers.simulation_jobs import FIRST
from assur.scenes.bounds import MAX_SET
from assur.scenes.simulation.simulate import LEAST_MINUTES, MOST_MINUTES, MOST_PLANNING_MS, MOST_SEED, MOST_SEEDS


async def simulate(request: Request) -> Response:
    return await _begun(request, None, "jobs")


async def simulate_kept(request: Request) -> Response:
    folder, digest = folder_of(request), digest_of(request)
    if not folder.use(digest, "cell"):
        raise cell_jobs.unknown(digest)
    return await _begun(request, digest, "../../jobs")


async def _begun(request: Request, digest: str | None, jobs: str) -> Response:
    """Starts the simulation in the body. Raises `Problem`."""
    service, client = service_of(request), client_of(request)
    if not service.settings.simulation_workers:
        raise Problem("no-simulations", "ASSUR_SIMULATION_WORKERS is 0.")
    body = await read_admitted(request, PLAN_BODY_BYTES, simulation=True)

    async def begun() -> Response:
        return accepted(request, await service.simulation_order(digest, body, client), jobs)

    return await once(request, body, begun)


def components(most_minutes: float) -> dict[str, dict[str, Any]]:
    """The bodies, described. `most_minutes`: largest product of minutes and seeds that the service gives."""
    of_cell: dict[str, dict[str, Any]] = {
        "minutes": {
            "type": "number", "minimum": LEAST_MINUTES, "maximum": min(MOST_MINUTES, most_minutes),
            "description": f"length of each run, on its own clock; with all seeds at most {most_minutes:g}",
        },
        "seed": {"type": "integer", "minimum": 0, "maximum": MOST_SEED, "description": "seed of the first run"},
        "seeds": {
            "type": "integer", "minimum": 1, "maximum": MOST_SEEDS,
            "description": "number of runs, each with the next seed",
        },
        "planning_ms": {
            "type": "number", "minimum": 0, "maximum": MOST_PLANNING_MS,
            "description": "how long planning takes on the clock of the run",
        },
        "set": {"type": "object", "maxProperties": MAX_SET, "description": "values of the cell, by their paths"},
        "helps": {"type": "boolean", "description": "then try changes of the cell that would help"},
    }  # fmt: skip
    of_cell = {name: {**kind, "default": FIRST[name]} for name, kind in of_cell.items()}
    cell = {"anyOf": [ref("Cell"), {"type": "string", "description": "the text of a cell file, in YAML"}]}
    return {
        "SimulationOfCell": fields([], **of_cell),
        "Simulation": fields(["cell"], cell=cell, **of_cell),
    }
