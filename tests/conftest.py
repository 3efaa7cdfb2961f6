"""What every test runs under: hypothesis repeats itself.

Profiles of hypothesis, chosen by the environment variable ASSUR_HYPOTHESIS:

- ``repeatable`` (the default, and what `.ci/run` uses): the same examples on every run, no database, so that a
  red test is red for everyone;
- ``explore``: fresh random examples and ten times as many; what it finds becomes an `@example` in the test.

No profile has a deadline: a test says what is true, not how fast the machine was today.
"""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

_PATIENT = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True)

settings.register_profile("repeatable", _PATIENT, derandomize=True, database=None, max_examples=60)
settings.register_profile("explore", _PATIENT, max_examples=600)
settings.load_profile("repeatable" if os.environ.get("CI") else os.environ.get("ASSUR_HYPOTHESIS", "repeatable"))

# the files of a maker's robot may not be copied into the project: who has them names their folder
collect_ignore = [] if os.environ.get("ASSUR_MAKER_ROBOTS") else ["api/test_maker_robot.py"]
