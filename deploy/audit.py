"""Known vulnerabilities of the locked releases: `make audit`.

pip-audit queries the advisory service. If the service does not know a package, or does not answer for it, pip-audit
writes a note and still ends with 0. Here this is an error of its own: a release without an answer is not clean.

| exit code | means |
|---|---|
| 0 | every locked release was audited, and none has a known vulnerability |
| 1 | at least one has |
| 3 | at least one could not be audited; of the others, none has a known vulnerability |
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from deploy import locks

CLEAN, VULNERABLE, NOT_AUDITED = 0, 1, 3


@dataclass
class Verdict:
    """The result: releases that were `audited`, `vulnerable` ones with their advisories, and those `not_audited`."""

    audited: list[str] = field(default_factory=list)
    vulnerable: list[str] = field(default_factory=list)
    not_audited: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        return VULNERABLE if self.vulnerable else NOT_AUDITED if self.not_audited else CLEAN

    def lines(self) -> list[str]:
        found = [f"VULNERABLE {each}" for each in self.vulnerable] + [
            f"NOT AUDITED {each}" for each in self.not_audited
        ]
        end = f"{len(self.audited)} releases were audited, {len(self.vulnerable)} of them have known vulnerabilities"
        if self.not_audited:
            end += f"; {len(self.not_audited)} could not be audited, so nothing is known of them"
        return [*found, end]


def rounds(releases: Iterable[tuple[str, str]]) -> list[list[tuple[str, str]]]:
    """The releases (name, version), each once, in lists that have every name once: one package may be locked in two
    versions, for two Pythons, and pip-audit takes one at a time."""
    lists: list[list[tuple[str, str]]] = []
    for release in sorted(set(releases)):
        free = next((each for each in lists if release[0] not in {name for name, _ in each}), None)
        if free is None:
            lists.append(free := [])
        free.append(release)
    return lists


def judge(releases: Sequence[tuple[str, str]], answer: str, error: str, into: Verdict) -> None:
    """Reads the JSON that pip-audit wrote for these releases into `into`; `error` is its standard error."""
    try:
        audited: dict[str, Any] = {each["name"]: each for each in json.loads(answer)["dependencies"]}
    except (ValueError, KeyError, TypeError):
        last = (error.strip().splitlines() or ["no answer, and no error"])[-1]
        into.not_audited += [f"{name} {version}: {last}" for name, version in releases]
        return
    for name, version in releases:
        one = audited.get(name, {})
        if one.get("version") != version or "vulns" not in one:
            into.not_audited.append(f"{name} {version}: {one.get('skip_reason', 'left out of the answer')}")
            continue
        into.audited.append(f"{name} {version}")
        for fault in one["vulns"]:
            mended = ", ".join(fault.get("fix_versions", [])) or "no release"
            into.vulnerable.append(f"{name} {version}: {fault['id']}, mended in {mended}")


def ask(releases: Sequence[tuple[str, str]]) -> Verdict:
    """The advisories for the releases (name, version)."""
    verdict = Verdict()
    for some in rounds(releases):
        with tempfile.TemporaryDirectory() as folder:
            wanted = Path(folder) / "releases.txt"
            wanted.write_text("".join(f"{name}=={version}\n" for name, version in some), encoding="utf-8")
            command = [sys.executable, "-m", "pip_audit", "--requirement", str(wanted), "--no-deps", "--disable-pip"]
            command += ["--format", "json", "--progress-spinner", "off", *sys.argv[1:]]
            ran = subprocess.run(command, capture_output=True, text=True, check=False)
        judge(some, ran.stdout, ran.stderr, verdict)
    return verdict


def main() -> int:
    pins = [
        *locks.read(locks.RUNTIME.read_text(encoding="utf-8")),
        *locks.read(locks.BUILD.read_text(encoding="utf-8")),
    ]
    verdict = ask([(pin.name, pin.version) for pin in pins])
    print("\n".join(verdict.lines()))
    return verdict.exit_code


if __name__ == "__main__":
    sys.exit(main())
