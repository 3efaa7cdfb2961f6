"""From a URDF (or xacro) and its files to a robot's file of ours, with hulls of its meshes in the same folder.

All missing and unsuitable items are reported at once, and then nothing is written.
"""

from __future__ import annotations

import hashlib
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_TOOL_BODIES, MAX_YAML_BYTES
from assur.scenes.catalogue import RobotFile, load_robot
from assur.scenes.reading.arms import LINKS, BuiltArm, built
from assur.scenes.schema.read import read
from assur.scenes.schema.robots import ArmDocument
from assur.scenes.schema.stated import Status
from assur.scenes.text.yaml_text import parse_yaml
from assur.scenes.urdf import agreement, solids
from assur.scenes.urdf.arm_text import ArmText, angles, body_of, free_name, shared_head
from assur.scenes.urdf.carriers import Carrier, carrier_of, self_pairs
from assur.scenes.urdf.chain import chain_to, remarks_on
from assur.scenes.urdf.families import arm_in
from assur.scenes.urdf.limits import Limits, LimitsFile, limits_of, read_limits
from assur.scenes.urdf.mesh_files import mesh_triangles
from assur.scenes.urdf.plausible import implausible, size_of
from assur.scenes.urdf.reader import read_tree
from assur.scenes.urdf.refusals import Defect, ImportRefused, OfNoFamily, Unsuitable
from assur.scenes.urdf.solids import Covering, Part
from assur.scenes.urdf.srdf import Semantics, read_srdf
from assur.scenes.urdf.tree import Solid, Tree
from assur.scenes.urdf.xml_text import FARTHEST, MAX_XML_BYTES


@dataclass(frozen=True)
class ImportOptions:
    """How a robot is imported. `packages`: folders by name; `held`: joints that stay at a position; `status`: the
    status of the numbers in the files."""

    urdf: Path
    joint_limits: Path | None = None
    srdf: Path | None = None
    packages: dict[str, Path] = field(default_factory=dict)
    base: str | None = None
    tip: str | None = None
    held: dict[str, float] = field(default_factory=dict)
    name: str | None = None
    status: Status = "third_party"
    covering: Covering = field(default_factory=lambda: Covering(0.01, 8, open_hull=False))
    arguments: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ImportedRobot:
    """A robot's file, not written yet: its `text`, `meshes` by the name below its folder, and remarks on it."""

    name: str
    text: str
    meshes: dict[str, bytes]
    report: dict[str, Any]


def import_robot(wanted: ImportOptions) -> ImportedRobot:
    """The robot's file. Raises `ImportRefused` with all that is missing or unsuitable, or `OSError`."""
    content = _content(wanted.urdf, MAX_XML_BYTES)
    if wanted.urdf.suffix.lower() == ".xacro":
        from assur.scenes.urdf.xacro_text import expanded

        content = expanded(wanted.urdf, wanted.packages, wanted.arguments)
    given = (
        None
        if wanted.joint_limits is None
        else read_limits(_content(wanted.joint_limits, MAX_YAML_BYTES), wanted.joint_limits.name)
    )
    try:
        found = _Import(wanted, read_tree(content, wanted.urdf.name), given)
    except ImportRefused as first:
        # angles that are written with few digits may be all that is wrong: then read as the right angles they mean
        tree = read_tree(content, wanted.urdf.name, rounding=True)
        if not tree.rounded:
            raise
        try:
            found = _Import(wanted, tree, given)
        except ImportRefused as second:
            # the error of the family that knows the arm is reported (what is missing), not that it is of no family
            raise (second if isinstance(first, OfNoFamily) else first) from None
        found.tell_rounding(read_tree(content, wanted.urdf.name))
    return found.made(hashlib.sha256(content).hexdigest())


def write(imported: ImportedRobot, out: Path) -> RobotFile:
    """Writes the robot's file and its meshes, and reads it again as a user does."""
    for name, content in imported.meshes.items():
        path = out.parent / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    out.write_text(imported.text, encoding="utf-8")
    return load_robot(out)


def _content(path: Path, most: int) -> bytes:
    with path.open("rb") as file:
        return file.read(most + 1)


class _Import:
    """One attempt. Raises `ImportRefused`."""

    def __init__(self, wanted: ImportOptions, tree: Tree, given: LimitsFile | None) -> None:
        self.wanted, self.file = wanted, wanted.urdf.name
        self.remarks: list[str] = list(tree.remarks)
        if self.remarks and wanted.urdf.suffix.lower() == ".xacro":
            self.remarks.append(f"lines of {self.file} are those of the URDF to which xacro expands it")
        self.sizes: dict[str, float] = {}
        self.lacks: list[Defect] = []
        self._hold(tree)
        self.tree = tree = tree.with_held(wanted.held)
        self.semantics = Semantics(frozenset(), ())
        if wanted.srdf is not None:
            self.semantics = read_srdf(_content(wanted.srdf, MAX_XML_BYTES), wanted.srdf.name, tree)
        self.base = wanted.base or tree.root
        self.chain, self.kinematics, lacks, passed = arm_in(tree, self.file, self.base, wanted.tip, self.semantics.tips)
        self.lacks += lacks
        self.remarks += passed
        limits, lacks, remarks = limits_of(self.chain, given, self.file, wanted.status)
        self.lacks += lacks
        self.remarks += remarks
        self._look_at_meshes()
        kept = [each for each in limits if each is not None]
        if self.lacks or len(kept) < len(limits):
            raise ImportRefused(self.file, self.lacks)
        self.limits: list[Limits] = kept
        self.arm = self._built()
        ranges = [list(each.range.value) for each in kept]  # type: ignore[arg-type]
        self.ranges: list[list[float]] = ranges
        try:
            self.apart = agreement.hold_together(self.chain, self.arm, self.kinematics, ranges)
        except Unsuitable as error:
            raise ImportRefused(self.file, [error.lack]) from error

    def _hold(self, tree: Tree) -> None:
        for name, value in self.wanted.held.items():
            if name not in tree.joints:
                raise ImportRefused(
                    self.file, [Defect(f"--hold {name}", "no joint of this name", "a joint of the URDF")]
                )
            if not abs(value) <= FARTHEST:
                raise ImportRefused(self.file, [Defect(f"--hold {name}", f"{value:g}", "a number in rad or m")])
        for name, folder in self.wanted.packages.items():
            if not folder.is_dir():
                raise ImportRefused(self.file, [Defect(f"--package {name}", f"no folder {folder}", "a folder")])
        for what, link in (("--base", self.wanted.base), ("--tip", self.wanted.tip)):
            if link is not None and link not in tree.links:
                links = ", ".join(list(tree.links)[:20])
                raise ImportRefused(self.file, [Defect(f"{what} {link}", "no link of this name", f"one of {links}")])

    def _look_at_meshes(self) -> None:
        """Every mesh is read once before any is covered: their faults are reported together."""
        for link in self.chain.movers:
            for solid in self.tree.links[link]:
                try:
                    self.sizes[link] = max(self._size(solid), self.sizes.get(link, 0.0))
                except Unsuitable as error:
                    self.lacks.append(error.lack)

    def _size(self, solid: Solid) -> float:
        """How large a solid is along its longest side, m. Raises `Unsuitable` for a mesh that cannot be covered."""
        if solid.kind != "mesh":
            return size_of(solid)
        triangles = mesh_triangles(solid, self.wanted.urdf, self.wanted.packages)
        if not self.wanted.covering.open_hull:
            solids.closed(solid.where, triangles)
        return float(np.ptp(triangles.reshape(-1, 3), axis=0).max())

    def _built(self) -> BuiltArm:
        document, _ = parse_yaml(self._text().text().encode())
        try:
            given = read(ArmDocument, document).written_out()
        except InputError as error:
            raise ImportRefused(self.file, [self._of_number(error)]) from error
        if given is None:
            raise ImportRefused(self.file, [Defect("the file", "no arm", "report it")])
        return built(*given)

    def _of_number(self, error: InputError) -> Defect:
        """A number that our form does not take, at the file's joint if it is one of a joint."""
        if found := re.match(r"\w+\.joints\[(\d+)\]\.(\w+)", error.field):
            where = f"joint {self.chain.joints[int(found[1])].name}, {found[2]}"
        else:
            where = error.field
        lengths = "; a URDF has lengths in m: write mm times 0.001" if "_m." in error.field else ""
        return Defect(where, f"{error.value}", f"allowed is {error.allowed}{lengths}")

    def tell_rounding(self, written: Tree) -> None:
        """Says what the rounding of angles changed: how far away the flange of the file as it is `written` is."""
        chain, _ = chain_to(written.with_held(self.wanted.held), self.base, self.chain.tip)
        q = agreement.states(self.chain, self.ranges)
        if chain is None:
            raise ImportRefused(self.file, [Defect("the file", "two readings of it differ", "report it")])
        metres, radians = agreement.between(chain.places(q)[chain.tip], self.chain.places(q)[chain.tip])
        angles = ", ".join(self.tree.rounded[:6])
        self.remarks.append(
            f"angles written with few digits ({angles}) are read as the right angles that they mean: the flange of the "
            f"file as it is written is up to {1e6 * metres:.3g} um and {1e6 * radians:.3g} urad elsewhere"
        )

    def _text(
        self, bodies: tuple[dict[str, Any], ...] = (), pairs: tuple[tuple[str, str], ...] = (), **more: str
    ) -> ArmText:
        names = self.names
        joints = tuple(
            (names[i], joint.kind != "prismatic", limits)
            for i, (joint, limits) in enumerate(zip(self.chain.joints, self.limits, strict=True))
        )
        held = "".join(f", {name} held at {value:g}" for name, value in self.wanted.held.items())
        where = f"{self.file}, joint origins from link {self.base} to link {self.chain.tip}{held}"
        return ArmText(
            name=self.name,
            title=f"{self.tree.name}, imported from {self.file}",
            about=more.get("about", "-"),
            kinematics=self.kinematics,
            joints=joints,
            stated=(self.wanted.status, where),
            solids=(self.wanted.status, more.get("solids", "-")),
            bodies=bodies,
            pairs=pairs,
        )

    @property
    def name(self) -> str:
        plain = re.sub(r"[^a-z0-9]+", "-", (self.wanted.name or self.tree.name).lower()).strip("-")[:64]
        return plain or "robot"

    @property
    def names(self) -> list[str]:
        """Names of the joints: those of the file if they are short enough and have only letters and digits, else j1 and
        so on."""
        names = [joint.name for joint in self.chain.joints]
        if all(re.fullmatch(r"[A-Za-z][A-Za-z0-9]{0,15}", name) for name in names):
            return names
        return [f"j{i + 1}" for i in range(len(names))]

    def made(self, digest: str) -> ImportedRobot:
        """The file with the solids of the links."""
        parts, carried = self._parts()
        bodies, meshes = [], {}
        for part in parts:
            body, content = body_of(part, self.kinematics.family, self.arm, f"{self.name}-solids")
            bodies.append(body)
            if content is not None:
                meshes[body["shape"]["mesh"]["file"]] = content
        if len(bodies) > MAX_TOOL_BODIES:
            what = f"{len(bodies)} bodies cover the links"
            lack = Defect("the meshes", what, f"up to {MAX_TOOL_BODIES} are allowed: say a smaller --hulls")
            raise ImportRefused(self.file, [lack])
        names = LINKS[self.kinematics.family]
        off = None if self.wanted.srdf is None else self.semantics.off
        pairs = self_pairs(self.kinematics.family, carried, off, names)
        covers: dict[str, tuple[int, float]] = {}
        for part in parts:
            if part.hull is not None:
                count, far = covers.get(part.source, (0, 0.0))
                covers[part.source] = (count + 1, max(far, part.excess_m))
        tight = self.wanted.covering.tight_m
        self.remarks += [
            f"{of}: its hulls reach {1e3 * far:.1f} mm out of the mesh, more than the {1e3 * tight:g} mm of "
            f"--tolerance-mm, for it may have {self.wanted.covering.most} of them (--hulls)"
            for of, (_, far) in covers.items()
            if far > tight
        ]
        text = self._text(tuple(bodies), tuple(pairs), about=self._about(digest), solids=self._of_solids(covers)).text()
        report = {
            "name": self.name,
            "family": self.kinematics.family,
            "axis_order": self.kinematics.order or None,
            "base": self.base,
            "flange": self.chain.tip,
            "flange_turn_deg": None if self._turn is None else self._turn,
            "joints": [
                {
                    "name": name,
                    "urdf": joint.name,
                    "sign": self.kinematics.signs[i],
                    "zero": self.kinematics.zeros[i],
                    "unit": "rad" if joint.kind != "prismatic" else "m",
                }
                for i, (name, joint) in enumerate(zip(self.names, self.chain.joints, strict=True))
            ],
            "states": agreement.STATES,
            "apart_m": self.apart[0],
            "apart_rad": self.apart[1],
            "bodies": len(bodies),
            "covers": [{"of": of, "hulls": count, "excess_m": far} for of, (count, far) in covers.items()],
            "self_pairs": [list(pair) for pair in pairs],
            "warnings": [*self.tree.warnings, *implausible(self.chain, self.limits, self.sizes)],
            "remarks": self.remarks,
            "unused": list(self.tree.unused),
        }
        return ImportedRobot(self.name, text, meshes, report)

    @property
    def _turn(self) -> list[float] | None:
        """Roll, pitch and yaw, deg, of the file's flange in ours, where they differ."""
        if np.abs(self.kinematics.turn - np.eye(3)).max() <= 1e-6:
            return None
        return [round(math.degrees(angle), 6) + 0.0 for angle in angles(self.kinematics.turn)]

    def _about(self, digest: str) -> str:
        joints = ", ".join(f"{n} is {j.name}" for n, j in zip(self.names, self.chain.joints, strict=True))
        turn = self._turn
        more = (
            "" if turn is None else f" The frame of that link is the flange's, turned by roll, pitch, yaw {turn} deg."
        )
        return (
            f"Imported from {self.file} (sha256 {digest[:16]}), base link {self.base}, flange link {self.chain.tip}. "
            f"Joints: {joints}.{more} A URDF has no loads: state max_load_kg and rated_load_kg here."
        )

    def _of_solids(self, covers: dict[str, tuple[int, float]]) -> str:
        covered = [f"{of}: {n} hulls, up to {1e3 * far:.1f} mm out of the mesh" for of, (n, far) in covers.items()]
        return "; ".join([f"collision shapes of {self.file}", *covered])[:3900]

    def _parts(self) -> tuple[list[Part], dict[str, set[str]]]:
        """The bodies of all links, and which of the file's links each of ours carries."""
        q = agreement.states(self.chain, self.ranges, 16)
        q[0] = 0.0
        theirs, ours = self.chain.places(q), agreement.frames(self.arm, q)
        found: list[Part] = []
        carried: dict[str, set[str]] = {}
        lacks: list[Defect] = []
        taken: set[str] = set()
        self.remarks += remarks_on(self.chain)
        for link, movers in self.chain.movers.items():
            for i, solid in enumerate(self.tree.links[link]):
                several = len(self.tree.links[link]) > 1
                name = free_name(self._short(link) + (f"-{chr(97 + i % 26)}" if several else ""), taken)
                try:
                    carrier = self._carrier(link, movers)
                    carried.setdefault(carrier.name, set()).add(link)
                    found += self._riding(name, solid, carrier, theirs[link], ours)
                except Unsuitable as error:
                    lacks.append(error.lack)
        if lacks:
            raise ImportRefused(self.file, lacks)
        return found, carried

    def _carrier(self, link: str, movers: frozenset[int]) -> Carrier:
        """What carries a link. On a SCARA's flange solids are on the quill, revolved, unless they may touch link 2: its
        pair with link 2 must stay for the tool."""
        found = carrier_of(movers, self.kinematics, len(self.chain.joints))
        if found is None:
            raise Unsuitable(f"link {link}", "no link of ours moves as it does", "remove its collision shapes")
        if self.kinematics.family == "scara" and found.name == "flange":
            return Carrier("quill", len(self.chain.joints) - 1)
        return found

    def _riding(
        self, name: str, solid: Solid, carrier: Carrier, link: FloatArray, ours: dict[str, FloatArray]
    ) -> list[Part]:
        more = (self.wanted.packages, self.wanted.covering)
        frame = ours[carrier.name]
        if carrier.about is None:
            return solids.exact(
                carrier.name, name, solid, agreement.place_in(frame, link, turning=False), self.wanted.urdf, more
            )
        local = agreement.place_in(frame, link, turning=True)
        at = np.zeros(3)
        if carrier.name != "quill":
            point = np.append(self.chain.axes[carrier.about].point, 1.0)
            at[:2] = (np.linalg.inv(frame[0]) @ point)[:2]
        local[:3, 3] -= at
        parts = solids.revolved(carrier.name, name, solid, local, self.wanted.urdf, more)
        for part in parts:
            part.pose[:3, 3] += at
        self.remarks.append(
            f"{solid.where}: covered by upright cylinders ({len(parts)}) on {carrier.name}, which hold it at any angle"
        )
        return parts

    def _short(self, link: str) -> str:
        """A link's name for bodies: what all names of links begin with left out."""
        names = [each for each in self.chain.movers if each not in ("world", "map")]
        head = shared_head(names) if len(names) > 1 else ""
        plain = re.sub(r"[^A-Za-z0-9]+", "-", link.removeprefix(head)).strip("-")[:40]
        return plain if plain[:1].isalpha() else f"link-{plain}"
