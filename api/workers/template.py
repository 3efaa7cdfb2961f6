"""Makes the process that imports it the template from which workers are forked. Only the fork server imports it.

A fork takes some ms, where loading the libraries and the kernels takes seconds, and what is loaded here is in memory
once for all workers. The template plans once, and takes no jobs.
"""

from __future__ import annotations

import gc
import signal

from assur.api.logs import LOGGER
from assur.api.workers import jobs
from assur.planner.compiled import load_defined

# A service manager may signal the whole group: the web process then drains, and may need another worker meanwhile.
signal.signal(signal.SIGTERM, signal.SIG_IGN)
try:
    jobs.warm()
    load_defined()
except Exception:  # noqa: BLE001 - each worker plans, too, and says why it cannot
    LOGGER.exception("the template of the workers could not plan")
gc.collect()
gc.freeze()
