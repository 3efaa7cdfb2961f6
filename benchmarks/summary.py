"""A run over a problem set in one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from rich.table import Table

from benchmarks.translation import Document

FAST_S = 0.1
SOON_S = 1.0


def figures(lines: Sequence[Document]) -> dict[str, str]:
    """The figures of a run in the order of the table: counts over all problems, times over the solved ones."""
    solved = [line for line in lines if line["status"] == "planned" and line["checked"]]
    first = np.array([line["first_s"] for line in solved])
    proved = np.array([line["proved_s"] for line in solved])
    duration = np.array([line["duration_s"] for line in solved])
    return {
        "problems": str(len(lines)),
        f"solved within {FAST_S:g} s": _share(int((first <= FAST_S).sum()), len(lines)),
        f"solved within {SOON_S:g} s": _share(int((first <= SOON_S).sum()), len(lines)),
        "first answer, p50 / p95 / longest": _quantiles(first * 1e3, "{:.1f}") + " ms",
        "proof found, p50 / p95 / longest": _quantiles(proved * 1e3, "{:.1f}") + " ms",
        "duration, p50 / p95 / longest": _quantiles(duration, "{:.3f}") + " s",
        "refused by the checker": str(sum(line["status"] == "planned" and not line["checked"] for line in lines)),
        "errors": str(sum(line["status"] == "error" for line in lines)),
    }


def summary(name: str, lines: Sequence[Document]) -> Table:
    """The figures, and below them which problems were not solved, by reason."""
    table = Table("", "", title=name, show_header=False)
    for title, value in figures(lines).items():
        table.add_row(title, value)
    table.add_section()
    for reason, count in Counter(_leading(line) for line in lines if line["status"] != "planned").most_common():
        names = [str(line["id"]) for line in lines if line["status"] != "planned" and _leading(line) == reason]
        table.add_row(f"{count} {reason}", " ".join(names))
    return table


def _leading(line: Document) -> str:
    return str(line["reason"]).partition(":")[0]


def _share(count: int, total: int) -> str:
    return f"{count} ({100 * count / total:.0f} %)" if total else "none"


def _quantiles(values: np.ndarray, form: str) -> str:
    if not len(values):
        return "none"
    return " / ".join(form.format(float(np.quantile(values, share))) for share in (0.5, 0.95, 1.0))
