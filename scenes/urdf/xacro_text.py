"""A xacro file expanded to a URDF by the library xacrodoc (the extra `xacro`), in a process of its own.

A xacro file is a program: it evaluates expressions and includes other files. It is run for the user who names it on
the command line, for a bounded time, and no service ever runs one.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

from assur.scenes.urdf.mesh_files import package_above
from assur.scenes.urdf.refusals import Defect, ImportRefused

LONGEST_S = 60.0
"""A macro may call itself without end."""
MOST_PACKAGES = 32
"""Number of packages of one file that are searched."""
LOST = "package not found: "
PROGRAM = f"""
import json, sys
given = json.load(sys.stdin)
import xacro
from xacrodoc import XacroDoc, packages
packages.update_package_cache(given["packages"])
try:
    found = XacroDoc.from_file(given["file"], subargs=given["arguments"], resolve_packages=False)
except BaseException as error:
    within = error
    while within is not None:
        if isinstance(within, packages.PackageNotFoundError):
            sys.exit("{LOST}" + str(within.args[0]))
        within = getattr(within, "exc", None) or within.__cause__ or within.__context__
    stack = [name for name in getattr(xacro, "filestack", None) or [] if name]
    place = " in " + stack[-1] if stack else ""
    sys.exit(" ".join((type(error).__name__ + ": " + str(error) + place).split()))
sys.stdout.buffer.write(found.dom.toxml().encode("utf-8"))
"""


def expanded(path: Path, packages: dict[str, Path], arguments: dict[str, str]) -> bytes:
    """The URDF that a xacro file expands to, with the folders of packages and values of its arguments.

    Raises `ImportRefused` where the library is not installed, and for whatever it cannot expand.
    """
    if importlib.util.find_spec("xacrodoc") is None:
        supply = "install assur with the extra `xacro`, or expand the file yourself and give the URDF"
        raise ImportRefused(path.name, [Defect("the file", "no library for xacro is installed", supply)])
    known = dict(packages)
    while True:
        run = _run(path, known, arguments)
        if run.returncode == 0:
            return run.stdout
        lines = run.stderr.decode("utf-8", "replace").strip().splitlines()
        reason = lines[-1][:400] if lines else "no reason given"
        if not reason.startswith(LOST):
            supply = "mend it, give an argument with --arg NAME=VALUE, or a package with --package NAME=FOLDER"
            raise ImportRefused(path.name, [Defect("the file", f"xacro does not expand it ({reason})", supply)])
        name = reason.removeprefix(LOST)
        folder = None if name in known or len(known) > MOST_PACKAGES else package_above(name, path)
        if folder is None:
            supply = f"say --package {name}=FOLDER; where nothing is included from it, any folder will do"
            raise ImportRefused(path.name, [Defect("the file", f"the folder of package {name!r} is not known", supply)])
        known[name] = folder


def _run(path: Path, packages: dict[str, Path], arguments: dict[str, str]) -> subprocess.CompletedProcess[bytes]:
    given = {
        "file": str(path.resolve()),
        "packages": {name: str(folder.resolve()) for name, folder in packages.items()},
        "arguments": arguments,
    }
    try:
        return subprocess.run(  # noqa: S603 - the program is ours; what it is given comes as data
            [sys.executable, "-c", PROGRAM],
            input=json.dumps(given).encode(),
            capture_output=True,
            timeout=LONGEST_S,
            cwd=path.resolve().parent,
            check=False,
        )
    except subprocess.TimeoutExpired:
        supply = "a file whose macros come to an end"
        raise ImportRefused(path.name, [Defect("the file", f"not expanded within {LONGEST_S:g} s", supply)]) from None
