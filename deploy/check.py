"""Checks the files of the deployment against published schemas, and their numbers: `make check-deployment`.

Ends with 0 if all is right; else with 1, and one line for each fault.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import yaml
from check_jsonschema.builtin_schemas import get_builtin_schema
from jsonschema.validators import validator_for

from assur.planner.errors import InputError
from deploy import fits, locks, manifests

ROOT = Path(__file__).parents[1]
COMPOSE = ROOT / "compose.yaml"


def adapter() -> dict[str, Any]:
    """The values for prometheus-adapter."""
    values = (manifests.FOLDER / "prometheus-adapter-values.yaml").read_text(encoding="utf-8")
    document: dict[str, Any] = yaml.safe_load(values)
    return document


def version() -> str:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return str(project["version"])


def of_kubernetes(folder: Path = manifests.FOLDER) -> list[str]:
    """Faults of the manifests, by schema and by number."""
    try:
        read = manifests.read(folder)
        return [*manifests.against_schemas(read.resources), *fits.misfits(read, adapter(), version())]
    except (InputError, ValueError) as error:
        return [str(error)]


def of_compose(path: Path = COMPOSE) -> list[str]:
    """Faults of a compose file by the schema of the compose specification, which check-jsonschema has."""
    schema = get_builtin_schema("vendor.compose-spec")
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    found = validator_for(schema)(schema).iter_errors(document)
    return [f"{path.name}: {error.json_path}: {error.message[:300]}" for error in found]


def of_locks() -> list[str]:
    """Requirements of pyproject.toml that the lock files do not meet."""
    run, build = locks.of_project()
    return [
        f"{path.name}: {fault}; run make lock"
        for wanted, path in ((run, locks.RUNTIME), (build, locks.BUILD))
        for fault in locks.unmet(wanted, locks.read(path.read_text(encoding="utf-8")))
    ]


def of_kubectl(folder: Path = manifests.FOLDER) -> list[str]:
    """Faults of the kustomization by kubectl, which needs no cluster for it; nothing if there is no kubectl."""
    kubectl = shutil.which("kubectl")
    if kubectl is None:
        print("not run: kubectl kustomize, for there is no kubectl")
        return []
    ran = subprocess.run([kubectl, "kustomize", str(folder)], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        return ran.stderr.strip().splitlines() or [f"kubectl kustomize ended with {ran.returncode}"]
    sent = [each["kind"] for each in yaml.safe_load_all(ran.stdout) if each]
    ours = [each["kind"] for each in manifests.read(folder).resources]
    return [] if sorted(sent) == sorted(ours) else [f"kubectl sends {sent}, and {ours} were checked"]


def main() -> int:
    parts = {"kubernetes": of_kubernetes, "kubectl": of_kubectl, "compose": of_compose, "locks": of_locks}
    faults = [f"{name}: {fault}" for name, check in parts.items() for fault in check()]
    print("\n".join(faults) if faults else "deployment: manifests, compose.yaml and locks are as they must be")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
