"""The prints that were started with a run id."""

from __future__ import annotations

from passo.job.live.runs import Run
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


@operation(
    "runs.get",
    "GET",
    "/runs/{run}",
    Role.VIEWER,
    errors=("run.unknown", "run.invalid", "run.damaged"),
)
async def get(call: Call, run: str) -> Run:
    """The state of the print that was started with a run id (`job.start`)."""
    return await call.bridge.run_of(run)
