"""Every bound on the size of a request, in one place.

They keep a request's cost in proportion to its length; none of them is a fact about robots. The schema that
`request_schema()` gives carries them, so a client can check before it posts.
"""

from __future__ import annotations

from typing import Final

from assur.planner.model.options import LONGEST_BUDGET_S, MOST_CANDIDATES

MAX_BODIES: Final = 1_000
"""Bodies of the surroundings: a crowded cell has a hundred."""
MAX_FRAMES: Final = 256
"""Frames of the cell."""
MAX_SLOTS: Final = 10_000
"""Slots of a grid along one axis."""
MAX_STREAMS: Final = 16
"""Streams of parts of a cell."""
MAX_ARRIVALS: Final = 100_000
"""Parts that one stream brings in a run, and rows of a table of arrivals: a part a second for a day."""
MAX_ARRIVALS_BYTES: Final = 8 * 2**20
"""A table of arrivals."""
MAX_SET: Final = 256
"""Values that a task sets."""
MAX_STEPS: Final = 64
"""Control points of one task."""
MAX_PATH_PARTS: Final = 200
"""Parts of one path of a step."""
MAX_PATH_POINTS: Final = 200
"""Points of one spline of a path."""
MAX_TOOL_BODIES: Final = 64
"""Bodies of one tool, or of one inline robot."""
MAX_NEIGHBOURS: Final = 8
"""Other robots in the cell."""
MAX_CHANGES: Final = 1_000
"""Commanded changes of speed of one conveyor or turntable, or points of one keyframe law."""
MAX_CONTACTS: Final = 64
"""Bodies that one pick or place may name as touched by the part."""
MAX_JOINTS: Final = 16
"""Joints of an arm."""
MAX_KNOTS: Final = 50_000
"""Knots of a trajectory in a document."""
SHORTEST_STEP_S: Final = 1e-9
"""Between two knots, s: times of ROS are whole nanoseconds. Coefficients of a much shorter quintic overflow."""
LONGEST_LEAD_S: Final = 0.1
"""By how much later stamps may be than the motion, s: update periods of controllers are some ms."""
MAX_ROWS: Final = 500_000
"""Rows of a certificate in a document."""
MAX_TEXT: Final = 4_000
"""Characters of a text that people write (what a scenario is about)."""

MAX_DEPTH: Final = 32
"""Nesting of a document; ours have nine levels."""
MAX_INTEGER: Final = 2**53
"""Whole numbers beyond this are not the same in every JSON reader."""
MAX_JSON_BYTES: Final = 16 * 2**20
"""A document with a plan in it. The service sets a narrower limit for requests."""
MAX_PLAN_FILE_BYTES: Final = 64 * 2**20
"""A request with the meshes of its cell in it, and the answer to it, in one file."""
MAX_YAML_BYTES: Final = 256 * 2**10
"""A scenario file."""
MAX_LOG_BYTES: Final = 64 * 2**20
"""A file of recorded motion."""
MAX_ROW_CHARACTERS: Final = 8_192
"""A line of motion in CSV: `MAX_JOINTS` joints with three columns, and over a hundred characters for each."""
LINES_A_ROW: Final = 4
"""Lines of a CSV file for each row that it may have, comments and empty ones among them."""
MAX_LOG_ROWS: Final = 200_000
"""Rows of it: over three minutes at 1 kHz."""

MAX_FACES: Final = 200_000
"""Triangles of a mesh."""
MIN_FACES: Final = 4
"""A tetrahedron; nothing smaller encloses anything."""
MAX_MESH_BYTES: Final = 16 * 2**20
"""A mesh file, decoded."""
MAX_MESH_TEXT: Final = 4 * (MAX_MESH_BYTES // 3) + 4
"""The same in base64 characters."""
SMALLEST_MESH_M: Final = 1e-3
"""A mesh whose largest extent is smaller than a millimetre: its unit was mistaken."""
LARGEST_MESH_M: Final = 20.0
"""A mesh larger than a hall: its unit was mistaken."""

FAR_M: Final = 100.0
"""Coordinates, m: nothing further away concerns a SCARA; a larger value has probably the wrong unit."""
TURNS_RAD: Final = 1_000.0
"""Angles, rad."""
FAST_M_S: Final = 100.0
"""Speeds, m/s."""
FAST_RAD_S: Final = 1_000.0
"""Turning rates, rad/s."""
LEAST: Final = 1e-6
"""Least value, SI, of quantities that may not be 0: speeds, accelerations, jerks, durations, leads, loads, and scales.
No drive moves at micrometres a second, and no scale weighs milligrams: a smaller value has probably the wrong unit."""
STRONG: Final = 1e6
"""Accelerations and jerks of laws and joints, SI: results for larger ones would be rounding errors."""
LONG_S: Final = 100_000.0
"""Instants, s: a day and some."""
PLAN_S: Final = 1e7
"""Instants of a plan, s: `MAX_STEPS` steps of `LONG_S` each end by then, so that every plan can be read back."""
SHORTEST_RAMP_S: Final = 2e-3
"""The least time, s, in which a joint with parabolic blends reaches its speed, as the planner has it."""
LONGEST_RAMP_S: Final = 100.0
"""Time, s, in which a joint with parabolic blends reaches its speed: a controller has tenths of a second."""
MIN_BUDGET_S: Final = 1e-3
"""Seconds of search: in less time not even the start is checked."""
MAX_BUDGET_S: Final = LONGEST_BUDGET_S
"""Seconds of search that one request may ask for, and the same for its explanation."""
MAX_CANDIDATES: Final = MOST_CANDIDATES
"""Candidates that one request may ask for."""
HEAVY_KG: Final = 1_000.0
"""Masses, kg."""
HEAVY_KGM2: Final = 1_000.0
"""Moments of inertia, kg·m²."""
MAX_LOAD_ROWS: Final = 64
"""Rows of a table of shares by mass."""
MAX_YAW_RANGES: Final = 16
"""Forbidden ranges of yaw of one robot."""
