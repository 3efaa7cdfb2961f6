"""The manifests are as Kubernetes publishes its schemas, and their numbers fit each other and the service."""

from __future__ import annotations

import copy
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from assur.api.web.app import create_app
from assur.api.web.settings import Settings
from assur.planner.errors import InputError
from deploy import check, fits, manifests
from deploy.manifests import Manifests

ROOT = Path(__file__).parents[2]
READ = manifests.read()
Change = Callable[[Manifests], object]


def test_the_manifests_are_as_published_and_their_numbers_fit() -> None:
    assert check.of_kubernetes() == []


def test_kubectl_puts_them_together_where_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert check.of_kubectl() == []
    assert ("not run" in capsys.readouterr().out) == (shutil.which("kubectl") is None)


def test_there_is_what_a_service_needs() -> None:
    kinds = [each["kind"] for each in READ.resources]
    assert sorted(kinds) == [
        "ConfigMap",
        "Deployment",
        "HorizontalPodAutoscaler",
        "Namespace",
        "NetworkPolicy",
        "PodDisruptionBudget",
        "Service",
    ]
    assert READ.one("HorizontalPodAutoscaler")["apiVersion"] == "autoscaling/v2"


def container(read: Manifests) -> dict[str, Any]:
    found: dict[str, Any] = read.one("Deployment")["spec"]["template"]["spec"]["containers"][0]
    return found


def pod(read: Manifests) -> dict[str, Any]:
    found: dict[str, Any] = read.one("Deployment")["spec"]["template"]["spec"]
    return found


def scaler(read: Manifests) -> dict[str, Any]:
    found: dict[str, Any] = read.one("HorizontalPodAutoscaler")["spec"]
    return found


def changed(change: Change, settings: dict[str, str] | None = None) -> Manifests:
    """The manifests with something else in them."""
    other = Manifests(
        copy.deepcopy(READ.resources), {**READ.settings, **(settings or {})}, copy.deepcopy(READ.kustomization)
    )
    change(other)
    return other


def unchanged(_: Manifests) -> None:
    """For settings alone."""


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("Deployment", lambda it: it["spec"].update(replica=2)),
        ("Deployment", lambda it: it["spec"].update(replicas="two")),
        ("Deployment", lambda it: it["spec"].pop("selector")),
        ("Deployment", lambda it: it["spec"]["template"]["spec"]["containers"][0].update(livenessprobe={})),
        ("HorizontalPodAutoscaler", lambda it: it.update(apiVersion="autoscaling/v2beta2")),
        ("Service", lambda it: it["spec"]["ports"][0].update(port="http")),
        ("NetworkPolicy", lambda it: it.update(kind="NetworkPolice")),
    ],
)
def test_what_the_schemas_do_not_know_is_found(kind: str, change: Callable[[Any], object]) -> None:
    document = copy.deepcopy(READ.one(kind))
    assert manifests.against_schemas([document], ["1.37"]) == []
    change(document)
    assert len(manifests.against_schemas([document], ["1.37"])) == 1


@pytest.mark.parametrize(
    ("change", "settings", "words"),
    [
        (lambda it: pod(it).update(terminationGracePeriodSeconds=60), {}, "terminationGracePeriodSeconds"),
        (unchanged, {"ASSUR_QUEUE_WAIT_S": "60"}, "terminationGracePeriodSeconds"),
        (unchanged, {"ASSUR_DRAIN_S": "30"}, "terminationGracePeriodSeconds"),
        (unchanged, {"ASSUR_DRAIN_S": "5"}, "ASSUR_DRAIN_S is 5"),
        (unchanged, {"ASSUR_WARM_S": "600"}, "ASSUR_WARM_S"),
        (lambda it: container(it)["readinessProbe"]["httpGet"].update(path="/livez"), {}, "ask /readyz"),
        (lambda it: container(it)["livenessProbe"]["httpGet"].update(path="/readyz"), {}, "asks /livez"),
        (lambda it: container(it)["livenessProbe"].update(failureThreshold=1), {}, "gives up within 15 s"),
        (unchanged, {"ASSUR_WORKERS": "0"}, "ASSUR_WORKERS is 0"),
        (unchanged, {"ASSUR_WORKER_MEMORY_MIB": "4096"}, "12800Mi"),
        (unchanged, {"ASSUR_WORKERS": "3"}, "3 workers and 1 for simulations of 1024 MiB"),
        (lambda it: container(it)["resources"]["requests"].update(memory="4Gi"), {}, "above the limit"),
        (lambda it: container(it)["resources"]["requests"].update(cpu="500m"), {}, "requests.cpu"),
        (lambda it: container(it)["resources"]["limits"].update(cpu="2"), {}, "limits.cpu"),
        (lambda it: scaler(it).update(minReplicas=1), {}, "minReplicas"),
        (unchanged, {"ASSUR_JOB_KEPT_S": "1200"}, "stabilizationWindowSeconds"),
        (unchanged, {"ASSUR_JOB_KEPT_S": "7200"}, "clientIP.timeoutSeconds"),
        (unchanged, {"ASSUR_PORT": "9000"}, "containerPort is 8000"),
        (lambda it: it.one("Service")["spec"].update(selector={"app": "assur"}), {}, "Service selects"),
        (lambda it: it.one("PodDisruptionBudget")["spec"].update(selector={"matchLabels": {}}), {}, "Budget selects"),
        (lambda it: scaler(it)["scaleTargetRef"].update(name="other"), {}, "scales Deployment other"),
        (lambda it: scaler(it)["metrics"][0]["pods"]["metric"].update(name="cpu"), {}, "asks for cpu"),
        (lambda it: it.kustomization["images"][0].update(newTag="0.0.9"), {}, "0.0.9"),
    ],
)
def test_numbers_that_do_not_fit_are_found(change: Change, settings: dict[str, str], words: str) -> None:
    found = list(fits.misfits(changed(change, settings), check.adapter(), check.version()))
    assert found
    assert any(words in each for each in found), found


def test_a_setting_that_the_service_would_refuse_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "kubernetes"
    shutil.copytree(manifests.FOLDER, folder)
    settings = folder / "settings.env"
    settings.write_text(settings.read_text(encoding="utf-8") + "ASSUR_WORKER=3\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"did you mean ASSUR_WORKERS\?"):
        list(fits.misfits(manifests.read(folder), check.adapter(), check.version()))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [("resources:", "resource:", "resource: not among"), ("  - service.yaml\n", "", "service.yaml: kustomization")],
)
def test_what_the_kustomization_misspells_or_forgets_is_found(tmp_path: Path, old: str, new: str, words: str) -> None:
    folder = tmp_path / "kubernetes"
    shutil.copytree(manifests.FOLDER, folder)
    kustomization = folder / "kustomization.yaml"
    text = kustomization.read_text(encoding="utf-8")
    kustomization.write_text(text.replace(old, new), encoding="utf-8")
    assert words in check.of_kubernetes(folder)[0]  # before any schema is asked


def test_the_container_may_do_as_little_as_possible() -> None:
    assert pod(READ)["enableServiceLinks"] is False
    assert pod(READ)["automountServiceAccountToken"] is False
    whole, own = pod(READ)["securityContext"], container(READ)["securityContext"]
    assert whole["runAsNonRoot"] is True
    assert whole["seccompProfile"] == {"type": "RuntimeDefault"}
    assert own["readOnlyRootFilesystem"] is True
    assert own["allowPrivilegeEscalation"] is False
    assert own["capabilities"] == {"drop": ["ALL"]}
    (user,) = re.findall(r"^USER (\d+):(\d+)$", (ROOT / "Dockerfile").read_text(encoding="utf-8"), re.MULTILINE)
    assert (str(whole["runAsUser"]), str(whole["runAsGroup"])) == user
    assert READ.one("NetworkPolicy")["spec"]["egress"] == []


def test_keys_are_an_optional_secret_that_is_not_in_the_repository() -> None:
    (volume,) = pod(READ)["volumes"]
    assert volume["secret"]["optional"] is True
    assert "Secret" not in {each["kind"] for each in READ.resources}


def test_what_probes_and_prometheus_ask_is_served() -> None:
    served = set(create_app(Settings()).openapi()["paths"])
    paths = {container(READ)[f"{each}Probe"]["httpGet"]["path"] for each in ("startup", "readiness", "liveness")}
    annotations = READ.one("Deployment")["spec"]["template"]["metadata"]["annotations"]
    assert paths | {annotations["prometheus.io/path"]} <= served
    (port,) = container(READ)["ports"]
    assert annotations["prometheus.io/port"] == str(port["containerPort"])
    assert READ.one("Service")["spec"]["ports"][0]["targetPort"] == port["name"]


def test_the_metric_of_the_autoscaler_is_one_of_the_service() -> None:
    (metric,) = scaler(READ)["metrics"]
    assert f"`{metric['pods']['metric']['name']}`" in (ROOT / "docs" / "operating.md").read_text(encoding="utf-8")


def test_the_compose_file_is_as_published(tmp_path: Path) -> None:
    assert check.of_compose() == []
    document = yaml.safe_load(check.COMPOSE.read_text(encoding="utf-8"))
    next(iter(document["services"].values()))["read-only"] = True
    other = tmp_path / "compose.yaml"
    other.write_text(yaml.safe_dump(document), encoding="utf-8")
    (fault,) = check.of_compose(other)
    assert "read-only" in fault


def test_quantities_of_kubernetes_are_read() -> None:
    assert [fits.mebibytes(each) for each in ("512Mi", "2Gi", "1024Ki")] == [512.0, 2048.0, 1.0]
    assert [fits.processors(each) for each in ("2", "500m")] == [2.0, 0.5]
    with pytest.raises(ValueError, match="2G"):
        fits.mebibytes("2G")
