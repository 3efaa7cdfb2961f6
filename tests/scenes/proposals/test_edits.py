"""Values are changed in a text; its comments, its order and its layout stay."""

from __future__ import annotations

import pytest

from assur.planner.errors import InputError
from assur.scenes.proposals.edits import Text

BLOCK = """# a cell
request:
  bodies:
    - name: table # the left one
      pose:
        at_mm: [1, 2.5, 3] # measured
    - {name: 'b.c', pose: {at_m: [0.1, 0, 0]}, mass_kg: 1}
  options:
    # the search
    seed: 1
    latest_end_ms: 900 # soon

    rules:
      - {a: 1} # first
expect: {status: planned}
"""
FLOW = '{"request": {"bodies": [{"name": "a", "pose": {}}], "options": {"seed": 1, "end": "rest"}}, "about": "x"}'
REACH = """\
pick:
  window_mm:   # from the light barrier
  - -250
  # both
  - -240  # end of the reach
  names: [ a,  'b' ] # of both
  corners:
    - [0, 0]
    - [1, 1]
"""
CHANGES = [
    (BLOCK, "request.bodies[0].pose.at_mm", [4, 5, 6], "at_mm: [1, 2.5, 3]", "at_mm: [4, 5, 6]"),
    (BLOCK, "request.bodies[0].pose.at_mm[1]", 7.25, "1, 2.5, 3", "1, 7.25, 3"),
    (BLOCK, "request.bodies[0].pose.at_m", [0.0123, 0, 3], "at_mm: [1, 2.5, 3]", "at_mm: [12.3, 0, 3000]"),
    (BLOCK, "request.bodies[0].pose.at_m[0]", 0.0123, "[1, 2.5, 3]", "[12.3, 2.5, 3]"),
    (BLOCK, "request.bodies[1].pose.at_mm[2]", 5, "[0.1, 0, 0]", "[0.1, 0, 0.005]"),
    (BLOCK, "request.bodies[1].mass_kg", 2, "mass_kg: 1", "mass_kg: 2"),
    (BLOCK, "request.bodies[1].yaw_deg", 30, "mass_kg: 1}", "mass_kg: 1, yaw_deg: 30}"),
    (BLOCK, "request.options.seed", 12, "seed: 1", "seed: 12"),
    (BLOCK, "request.options.elbow", "auto", "{a: 1} # first\n", "{a: 1} # first\n    elbow: auto\n"),
    (BLOCK, "request.options.end", "no", "{a: 1} # first\n", '{a: 1} # first\n    end: "no"\n'),
    (BLOCK, "request.carry.mm", 3, "{a: 1} # first\n", "{a: 1} # first\n  carry: {mm: 3}\n"),
    (BLOCK, "request.options.rules", [{"a": 1}, {"b": 2}], "{a: 1} # first\n", "{a: 1} # first\n      - {b: 2}\n"),
    (
        BLOCK,
        "request.options",
        {"seed": 1, "rules": [{"a": 1}]},
        "    latest_end_ms: 900 # soon\n",
        "",
    ),
    (FLOW, "request.options", {"end": "rest"}, '"seed": 1, ', ""),
    (FLOW, "request.options", {"seed": 1}, ', "end": "rest"', ""),
    (FLOW, "request.options.elbow", "auto", '"rest"', '"rest", "elbow": "auto"'),
    (FLOW, "request.bodies[0].pose.at_mm", [1, 2, 3], "{}", '{"at_mm": [1, 2, 3]}'),
    ("a:\n  b: 1\n", "a.c", 2, "  b: 1\n", "  b: 1\n  c: 2\n"),
    ("a:\n  b: 1", "a.c", 2, "  b: 1", "  b: 1\n  c: 2"),
    ("a:\n  b: |\n    long\n    text\nd: 1\n", "a.c", 2, "    text\n", "    text\n  c: 2\n"),
    ("a: 1\n", "set.x", 2, "a: 1\n", "a: 1\nset: {x: 2}\n"),
    (REACH, "pick.window_mm", [-250, -230], "- -240", "- -230"),
    (REACH, "pick.window_mm", [-0.5, None], "- -250\n  # both\n  - -240", "- -0.5\n  # both\n  - null"),
    (REACH, "pick.window_m", [-0.25, -0.23], "- -240", "- -230"),
    (REACH, "pick.names", ["a", "on"], "[ a,  'b' ]", '[ a,  "on" ]'),
    (REACH, "pick.corners", [[0, 0], [2, 1]], "- [0, 0]\n    - [1, 1]", "[[0, 0], [2, 1]]"),
    ("a:\n- |\n  long\n- b # c\n", "a", ["d", "b"], "|\n  long", "d"),
    ("w:\n-\n- 3 # mm\n", "w", [1, 3], "-\n- 3", "- 1\n- 3"),
    ("w:\n-   # none\n- 3\n", "w", [1, 3], "-   # none", "- 1   # none"),
    ("w: # none\nb: 1\n", "w", [1, 3], "w:", "w: [1, 3]"),
    ("- x\n- a:\n    m: 3\n", "[1].a.m", 4, "m: 3", "m: 4"),
]


@pytest.mark.parametrize(("content", "field", "value", "before", "after"), CHANGES)
def test_only_what_is_changed_is_another(content: str, field: str, value: object, before: str, after: str) -> None:
    assert content.count(before) == 1
    assert Text(content).with_value(field, value).content == content.replace(before, after)


def test_all_values_are_as_they_were_but_one() -> None:
    for field in Text(BLOCK).spans:
        if field not in ("request", "expect") and not field.endswith("name"):
            made = Text(BLOCK).with_value(field, 17)
            left = {path for path in Text(BLOCK).spans if path == field or not path.startswith(field)}
            assert left == made.spans.keys(), field


@pytest.mark.parametrize("field", ["request.bodies[2]", "request.bodies[0].pose.at_mm[3]", "expect.status.x"])
def test_a_place_that_the_text_has_not_is_refused(field: str) -> None:
    with pytest.raises(InputError):
        Text(BLOCK).with_value(field, 1)
