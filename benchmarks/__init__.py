"""The benchmark problems, a run over them, and an independent recheck of every answer.

One process, one core: numerical libraries read how many threads they may use when they are first imported. So the
number is set here, before anything imports them.
"""

import os

for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")
