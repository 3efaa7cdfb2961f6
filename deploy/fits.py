"""Whether the numbers of the manifests fit each other and the settings of the service.

`misfits` gives one sentence for each number that does not: its value, the required value, and the reason.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from assur.api.web.settings import WEB_MIB, Settings
from deploy.manifests import Document, Manifests

FROM_IMAGE = {"ASSUR_HOST": "0.0.0.0"}
"""Settings of the image; the manifests do not repeat them."""
SLACK_S = 4.0
"""Time in which a pod that is not ready any more has left the endpoints of every node and proxy, s."""
UNITS = {"Ki": 2.0**-10, "Mi": 1.0, "Gi": 2.0**10, "Ti": 2.0**20}


def mebibytes(quantity: str) -> float:
    """A quantity of memory of Kubernetes in MiB; decimal suffixes are not used here."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)(Ki|Mi|Gi|Ti)", quantity)
    if match is None:
        raise ValueError(f"{quantity}: memory is written with Ki, Mi, Gi or Ti")
    return float(match.group(1)) * UNITS[match.group(2)]


def processors(quantity: str) -> float:
    """A quantity of processors, or of a metric, of Kubernetes."""
    return float(quantity[:-1]) / 1000 if quantity.endswith("m") else float(quantity)


def _within_s(probe: Mapping[str, Any]) -> float:
    """Time until a probe that fails from now on takes effect, s."""
    return float(probe["periodSeconds"] * probe["failureThreshold"] + probe["timeoutSeconds"])


def misfits(manifests: Manifests, adapter: Document, version: str) -> Iterator[str]:
    """Every number that does not fit. `adapter`: the values for prometheus-adapter; `version`: that of the project.

    Raises `InputError` for a setting that the service would refuse.
    """
    settings = Settings.from_environment({**FROM_IMAGE, **manifests.settings})
    pod = manifests.one("Deployment")["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    yield from _times(pod, container, settings)
    yield from _sizes(container, manifests, settings)
    yield from _names(container, manifests, adapter, version)


def _times(pod: Document, container: Document, settings: Settings) -> Iterator[str]:
    needed, given = settings.drain_s + settings.stop_s, pod["terminationGracePeriodSeconds"]
    if given < needed:
        yield f"terminationGracePeriodSeconds is {given}: the service may take {needed:g} s to stop with its settings"
    startup, ready, alive = (container[each + "Probe"] for each in ("startup", "readiness", "liveness"))
    if startup["periodSeconds"] * startup["failureThreshold"] < settings.warm_s:
        yield f"startupProbe gives up before ASSUR_WARM_S ({settings.warm_s:g} s), within which workers may get ready"
    if startup["httpGet"]["path"] != "/readyz" or ready["httpGet"]["path"] != "/readyz":
        yield "startupProbe and readinessProbe ask /readyz"
    if alive["httpGet"]["path"] != "/livez":
        yield "livenessProbe asks /livez: a service that is only busy, or whose workers start anew, must not be killed"
    if _within_s(alive) < 30:
        yield f"livenessProbe gives up within {_within_s(alive):g} s: at least 30, for a restart loses the pod's jobs"
    if settings.drain_s < _within_s(ready) + SLACK_S:
        yield (
            f"ASSUR_DRAIN_S is {settings.drain_s:g}: readinessProbe sees within {_within_s(ready):g} s that the pod "
            f"stops, and proxies see it up to {SLACK_S:g} s later"
        )


def _sizes(container: Document, manifests: Manifests, settings: Settings) -> Iterator[str]:
    requests, limits = container["resources"]["requests"], container["resources"]["limits"]
    if not settings.workers:
        yield "ASSUR_WORKERS is 0 or not set: the memory limit can only fit a number of workers that is known"
    needed = (settings.workers + settings.simulation_workers) * settings.worker_memory_mib + WEB_MIB
    if mebibytes(limits["memory"]) < needed:
        yield (
            f"resources.limits.memory is {limits['memory']}: {settings.workers} workers and "
            f"{settings.simulation_workers} for simulations of "
            f"{settings.worker_memory_mib} MiB and {WEB_MIB} MiB for the web process are {needed}Mi"
        )
    if mebibytes(requests["memory"]) > mebibytes(limits["memory"]):
        yield "resources.requests.memory is above the limit"
    if processors(requests["cpu"]) < settings.workers:
        yield f"resources.requests.cpu is {requests['cpu']}: each of {settings.workers} workers takes a processor"
    if processors(limits["cpu"]) <= settings.workers:
        yield f"resources.limits.cpu is {limits['cpu']}: {settings.workers} workers leave nothing to the web process"
    spec = manifests.one("HorizontalPodAutoscaler")["spec"]
    if spec["minReplicas"] < 2:
        yield "minReplicas is below 2: the only pod would be down while its node is emptied"
    if spec["behavior"]["scaleDown"]["stabilizationWindowSeconds"] < settings.job_kept_s:
        yield f"scaleDown.stabilizationWindowSeconds is below ASSUR_JOB_KEPT_S ({settings.job_kept_s:g} s)"
    affinity = manifests.one("Service")["spec"]["sessionAffinityConfig"]["clientIP"]["timeoutSeconds"]
    if affinity < settings.job_kept_s + settings.queue_wait_s + 2 * settings.max_budget_s:
        yield f"sessionAffinityConfig.clientIP.timeoutSeconds is {affinity}: a job waits, works and is kept for longer"


def _names(container: Document, manifests: Manifests, adapter: Document, version: str) -> Iterator[str]:
    (port,) = container["ports"]
    settings = Settings.from_environment({**FROM_IMAGE, **manifests.settings})
    if port["containerPort"] != settings.port:
        yield f"containerPort is {port['containerPort']}, and the service listens on {settings.port}"
    labels = manifests.one("Deployment")["spec"]["template"]["metadata"]["labels"]
    chosen = {
        "Deployment": manifests.one("Deployment")["spec"]["selector"]["matchLabels"],
        "Service": manifests.one("Service")["spec"]["selector"],
        "PodDisruptionBudget": manifests.one("PodDisruptionBudget")["spec"]["selector"]["matchLabels"],
        "NetworkPolicy": manifests.one("NetworkPolicy")["spec"]["podSelector"]["matchLabels"],
    }
    for kind, selector in chosen.items():
        if not selector or not set(selector.items()) <= set(labels.items()):
            yield f"{kind} selects {selector}, and the pods bear {labels}"
    target = manifests.one("HorizontalPodAutoscaler")["spec"]["scaleTargetRef"]
    if (target["kind"], target["name"]) != ("Deployment", manifests.one("Deployment")["metadata"]["name"]):
        yield f"the autoscaler scales {target['kind']} {target['name']}, which is not there"
    (metric,) = manifests.one("HorizontalPodAutoscaler")["spec"]["metrics"]
    (rule,) = adapter["rules"]["custom"]
    wanted = metric["pods"]["metric"]["name"]
    if rule["name"] != {"matches": f"^{wanted}$", "as": wanted} or not rule["seriesQuery"].startswith(wanted + "{"):
        yield f"the autoscaler asks for {wanted}, and the rule for prometheus-adapter gives {rule['name']}"
    if processors(metric["pods"]["target"]["averageValue"]) <= 0:
        yield "averageValue must be positive"
    (image,) = manifests.kustomization["images"]
    if image["name"] != container["image"] or ("digest" not in image and image.get("newTag") != version):
        yield f"kustomization.yaml gives image {image}, and the container asks for {container['image']} {version}"
