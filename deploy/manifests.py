"""The manifests of Kubernetes as documents, and their faults by the published schemas."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import kubernetes_validate
import yaml

FOLDER = Path(__file__).parent / "kubernetes"
RELEASES = ("1.30", "1.31", "1.32", "1.33", "1.34", "1.35", "1.36", "1.37")
"""Releases of Kubernetes whose schemas the manifests are held to, from the oldest that has all they use."""

KEYS = frozenset({"apiVersion", "kind", "namespace", "resources", "labels", "images", "configMapGenerator"})
"""The keys that our kustomization uses. kubectl refuses other keys, too, where it is installed."""

Document = dict[str, Any]


@dataclass(frozen=True)
class Manifests:
    """The documents that `kubectl apply -k` sends, without the digests at the end of names: the resources of the
    kustomization, and its settings (`ASSUR_…` → text)."""

    resources: tuple[Document, ...]
    settings: Mapping[str, str]
    kustomization: Document

    def one(self, kind: str) -> Document:
        """The only document of that kind."""
        (found,) = (each for each in self.resources if each["kind"] == kind)
        return found


def read(folder: Path = FOLDER) -> Manifests:
    """The kustomization in `folder`, with all that it names.

    Raises `ValueError` for a key that is not in `KEYS`, and for a file of the folder that is neither named nor known.
    """
    kustomization = yaml.safe_load((folder / "kustomization.yaml").read_text(encoding="utf-8"))
    strange = sorted(set(kustomization) - KEYS)
    if strange:
        raise ValueError(f"kustomization.yaml: {', '.join(strange)}: not among {', '.join(sorted(KEYS))}")
    (generator,) = kustomization["configMapGenerator"]
    (settings,) = generator["envs"]
    known = {"kustomization.yaml", "prometheus-adapter-values.yaml", settings, *kustomization["resources"]}
    idle = sorted(path.name for path in folder.iterdir() if path.name not in known)
    if idle:
        raise ValueError(f"{', '.join(idle)}: kustomization.yaml does not name it")
    resources: list[Document] = []
    for name in kustomization["resources"]:
        resources += [each for each in yaml.safe_load_all((folder / name).read_text(encoding="utf-8")) if each]
    values = dict(_variables((folder / settings).read_text(encoding="utf-8").splitlines()))
    generated = {"apiVersion": "v1", "kind": "ConfigMap", "metadata": {"name": generator["name"]}, "data": values}
    return Manifests((*resources, generated), values, kustomization)


def _variables(lines: Iterable[str]) -> Iterable[tuple[str, str]]:
    """Name and value of each line ``NAME=value``; as kustomize reads them, ``#`` begins a comment at a line's start."""
    for line in lines:
        if line.strip() and not line.startswith("#"):
            name, _, value = line.partition("=")
            yield name, value


def against_schemas(resources: Iterable[Document], releases: Iterable[str] = RELEASES) -> list[str]:
    """Faults of the documents by the schemas of these releases; unknown keys are faults, too."""
    found = []
    for document in resources:
        name = f"{document.get('kind')} {document.get('metadata', {}).get('name')}"
        for release in releases:
            try:
                kubernetes_validate.validate(document, release, strict=True)
            except kubernetes_validate.ValidationError as error:
                where = ".".join(str(part) for part in error.path) or "document"
                found.append(f"{name}: Kubernetes {release}: {where}: {error.message[:300]}")
            except kubernetes_validate.SchemaNotFoundError as error:
                found.append(f"{name}: Kubernetes {release}: {error.message}")
    return found
