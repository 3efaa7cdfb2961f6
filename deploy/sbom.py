"""The list of what an environment has installed (SBOM), as CycloneDX 1.6 in JSON.

    python -m deploy.sbom PYTHON OUT

`PYTHON` is the interpreter of the environment that is listed. The tool cyclonedx-bom makes the list. Here addresses are
removed from it, for the list must be the same on every machine, and it is checked against the published schema. The
image is built with this program, so it needs nothing but the standard library and what
`deploy/requirements-build.lock` has.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

VERSION = "1.6"
STRANGE = re.compile(r"://|(?<![\w.])/(?:home|Users|root|work|tmp|src|opt|var|usr)/|localhost|@[\w-]+\.[a-z]{2,}")
"""Addresses and paths of a machine: the list may have none of them."""
OWN = "assur"


def listed(python: Path, pyproject: Path) -> dict[str, Any]:
    """What the environment of the interpreter `python` has installed: a CycloneDX document.

    Raises `subprocess.CalledProcessError` if the tool fails, and `ValueError` if its list is not as published, has an
    address or a path in it, or is empty.
    """
    command = [sys.executable, "-m", "cyclonedx_py", "environment", "--output-reproducible", "--short-PURLs"]
    command += ["--spec-version", VERSION, "--output-format", "JSON", "--pyproject", str(pyproject), str(python)]
    made = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    document: dict[str, Any] = without_addresses(json.loads(made.stdout))
    # beside the main component, assur is listed once more where it is installed
    document["components"] = [each for each in document.get("components", []) if each["name"] != OWN]
    check(document)
    return document


def without_addresses(part: Any) -> Any:
    """A CycloneDX document, or a part of it, without references to pages of projects and without free text."""
    if isinstance(part, dict):
        gone = ("externalReferences", "description", "author", "authors")
        return {key: without_addresses(value) for key, value in part.items() if key not in gone}
    return [without_addresses(each) for each in part] if isinstance(part, list) else part


def check(document: dict[str, Any]) -> None:
    """Raises `ValueError` unless the document is as the published schema says, lists something, and names no place."""
    faults = JsonStrictValidator(SchemaVersion.V1_6).validate_str(json.dumps(document))
    if faults is not None:
        raise ValueError(f"the list is not CycloneDX {VERSION}: {faults}")
    if not document.get("components"):
        raise ValueError("the list is empty: is this the interpreter of the environment?")
    body = {key: value for key, value in document.items() if key != "$schema"}
    strange = STRANGE.search(json.dumps(body))
    if strange is not None:
        raise ValueError(f"the list names a place: {strange.group(0)}")


def main() -> None:
    python, out = Path(sys.argv[1]), Path(sys.argv[2])
    document = listed(python, Path(__file__).parents[1] / "pyproject.toml")
    out.write_text(json.dumps(document, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    print(f"{out}: {len(document['components'])} packages")


if __name__ == "__main__":
    main()
