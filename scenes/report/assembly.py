"""The page in one file: style, one script made of the modules, and the view, inline.

Browsers load no module files from a disk, so each module becomes a function, and what it exports the result of it. The
policy in the head names the digests of script and style: nothing else runs, and nothing is fetched.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from functools import cache
from pathlib import Path
from string import Template
from typing import Any

from assur.planner.errors import FaultError

PAGE = Path(__file__).parent / "page"
FIRST = "main.js"
"""The module that uses all others."""
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./([\w.-]+)";$', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:const|function|class) (\w+))", re.MULTILINE)


def text_of(name: str) -> str:
    """A file of the page."""
    return (PAGE / name).read_text(encoding="utf-8")


@cache
def script() -> str:
    """All modules as one script, those that others need before them."""
    found = dict[str, str]()
    _add(FIRST, found, ())
    body = "\n".join(found.values())
    return f'"use strict";\n(() => {{\nconst modules = {{}};\n{body}\n}})();\n'


def _add(name: str, found: dict[str, str], above: tuple[str, ...]) -> None:
    """Adds a module behind those that it imports. Raises `FaultError` for a ring of imports, and for a form of import
    that is not known here."""
    if name in above:
        raise FaultError(f"{name} imports itself")
    source = text_of(name)
    for _, other in IMPORT.findall(source):
        if other not in found:
            _add(other, found, (*above, name))
    exported = ", ".join(EXPORT.findall(source))
    inside = EXPORT.sub("", IMPORT.sub(lambda each: f'const {each[1]} = modules["{each[2]}"];', source))
    if re.search(r"^(import|export)\b", inside, re.MULTILINE):
        raise FaultError(f"{name} imports or exports in a form that is not known")
    found[name] = f'modules["{name}"] = (() => {{\n{inside}return {{ {exported} }};\n}})();'


def page(title: str, chips: str, facts: str, view: Any) -> str:
    """The whole page. `chips` and `facts` are HTML; the title is not. `view` None: what is played comes later."""
    style, code = text_of("style.css"), script()
    if "</script" in code or "</style" in style:
        raise FaultError("a part of the page would end its element")
    of_script, of_style = digests()
    policy = (
        f"default-src 'none'; script-src {of_script}; style-src {of_style}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
    return Template(text_of("page.html")).substitute(
        title=html.escape(title), policy=policy, style=style, chips=chips, facts=facts, view=inline(view), script=code
    )


@cache
def digests() -> tuple[str, str]:
    """Digests of the script and of the style, as a policy names them."""
    return _hash(script()), _hash(text_of("style.css"))


def inline(document: Any) -> str:
    """A document as JSON that may stand in an element of a page: no text in it can end the element."""
    text = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("&", "\\u0026")


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
