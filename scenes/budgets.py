"""The budgets of a request, before it is validated."""

from __future__ import annotations

import math
from typing import Any

from assur.scenes.schema.request import OptionsDocument
from assur.scenes.units import twin_of

BUDGETS = ("budget_s", "explain_budget_s")
"""Options that say for how long a request may be worked on."""
_DEFAULTS_S: dict[str, float] = {name: OptionsDocument.model_fields[name].default for name in BUDGETS}


def stated_budgets(document: dict[str, Any], most_s: float = math.inf) -> dict[str, float]:
    """The budgets of a request, in s, before it is validated, for callers that limit them. A budget that is not stated
    is the default, at most `most_s`. A value that is no number counts as not stated; the validation refuses it."""
    options = document.get("options")
    given = options if isinstance(options, dict) else {}
    found: dict[str, float] = {}
    for name in BUDGETS:
        found[name] = min(_DEFAULTS_S[name], most_s)
        for key, per_second in ((name, 1), (twin_of(name), 1000)):
            value = given.get(key)
            if isinstance(value, int | float) and not value < 0:
                found[name] = value / per_second
    return found


def silent(document: object, option: str) -> bool:
    """Whether a valid request does not state an option, in any of its units."""
    options = document.get("options") if isinstance(document, dict) else None
    return not isinstance(options, dict) or (option not in options and twin_of(option) not in options)
