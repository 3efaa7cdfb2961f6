"""The viewer of an answer in a notebook: the page of the report in a frame of its own."""

from __future__ import annotations

import html
import sys
import warnings
from collections.abc import Mapping
from typing import Any

NOTEBOOKS = ("IPython", "marimo")
"""What a notebook has loaded that shows `_repr_html_`."""
ELSEWHERE = "answer.report('report.html') writes the same page as a file that every browser opens"


class Shown:
    """The viewer of an answer, a page that needs no network. A notebook shows it where it is the last value of a cell,
    or where it is given to `display`."""

    def __init__(self, page: str, height_px: int) -> None:
        self._page, self._height_px = page, height_px

    def _repr_html_(self) -> str:
        # A frame with an origin of its own: what a request says reaches neither the notebook nor its kernel.
        return (
            f'<iframe srcdoc="{html.escape(self._page)}" sandbox="allow-scripts" title="assur" '
            f'style="width: 100%; height: {self._height_px}px; border: 0"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<the viewer of an answer: a notebook shows it; {ELSEWHERE}>"


def page_of(request: Mapping[str, Any], answer: Mapping[str, Any], title: str, about: str) -> str:
    """The report of an answer to a request, which says what the checker says. Raises `InputError` naming the field."""
    from assur.api.version import version
    from assur.scenes.requests import cell_of, report_page, verdict_on

    cell, document = cell_of(dict(request)), dict(answer)
    verdict = verdict_on(cell, document)
    return report_page(cell, document, title=title, about=about, verdict=verdict, version=version())


def tell_where_there_is_no_notebook() -> None:
    """Warns the caller's caller whom nobody shows what `show` gives."""
    if not any(name in sys.modules for name in NOTEBOOKS):
        warnings.warn(f"no notebook is running here, so nothing is shown; {ELSEWHERE}", stacklevel=3)
