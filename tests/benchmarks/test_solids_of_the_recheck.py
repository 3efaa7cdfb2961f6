"""The recheck's solids lie as the problems say, and collide where they overlap."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.recheck.arm import LINK_1, placed_bodies, tool
from benchmarks.recheck.surroundings import PlacedBody, collisions, goal_at, placed_obstacles
from benchmarks.soak.solids import Solid, solid_of


def test_solids_collide_where_they_overlap_and_nowhere_else() -> None:
    """Gaps are compared with fcl and coal in the tests of the simulation."""
    x = np.array([0.0, 0.0899, 0.0901, 5.0])
    centre = np.stack([x, 0.0 * x, 0.0 * x], axis=-1)
    post = PlacedBody("post", solid_of({"cylinder": {"radius_m": 0.04, "height_m": 0.3}}), centre, 0.0 * x)
    block = PlacedBody("block", solid_of({"box": {"size_m": [0.1, 0.06, 0.2]}}), np.zeros((4, 3)), 0.0 * x)
    assert collisions(block, post).tolist() == [0, 1]
    assert collisions(post, block).tolist() == [0, 1]


def test_a_pose_that_is_not_finite_is_refused() -> None:
    good = PlacedBody("link 1", LINK_1, np.zeros((1, 3)), np.zeros(1))
    for centre, yaw in ((np.full((1, 3), np.nan), np.zeros(1)), (np.zeros((1, 3)), np.full(1, np.inf))):
        with pytest.raises(ValueError, match="not finite"):
            collisions(good, PlacedBody("link 1", LINK_1, centre, yaw))


def test_a_capsule_lies_from_its_pivot_outwards_with_its_length_between_the_centres_of_its_caps() -> None:
    motion = {"kind": "swing", "pivot": [0.2, -0.1, 0.3], "phase": 0.5, "omega": -2.0}
    problem = {"obstacles": [{"type": "capsule", "radius": 0.03, "length": 0.4, "motion": motion}]}
    t = np.array([0.0, 0.7])
    (arm,) = placed_obstacles(problem, t)
    for i, angle in enumerate(0.5 - 2.0 * t):
        outwards = np.array([np.cos(angle), np.sin(angle), 0.0])
        for along in (-0.03, 0.43):
            for gap in (-1e-4, 1e-4):
                away = along + np.sign(along) * (0.01 + gap)
                ball = PlacedBody(
                    "ball", Solid(0.0, 0.0, 0.0, ball=0.01), motion["pivot"] + away * outwards[None], 0.0 * t[:1]
                )
                seen = PlacedBody(arm.name, arm.solid, arm.centre[i : i + 1], arm.yaw[i : i + 1])
                assert bool(len(collisions(ball, seen))) == (gap < 0)


def test_the_arm_stretched_along_x_lies_where_the_problems_say() -> None:
    q = np.array([[0.0, 0.0, 0.12, 0.3], [np.pi / 2, -np.pi / 2, 0.2, 0.0]])
    first, second, quill = placed_bodies(q)
    assert np.allclose(first.centre, [[0.1625, 0.0, 0.3], [0.0, 0.1625, 0.3]], atol=1e-15)
    assert np.allclose(second.centre, [[0.4625, 0.0, 0.36], [0.1375, 0.325, 0.36]], atol=1e-15)
    assert np.allclose(quill.centre, [[0.6, 0.0, 0.275], [0.275, 0.325, 0.355]], atol=1e-15)
    assert np.allclose(first.yaw, [0.0, np.pi / 2])
    assert np.allclose(second.yaw, [0.0, 0.0])
    reached = tool(q, np.zeros_like(q))
    assert np.allclose(reached.position, [[0.6, 0.0, 0.12], [0.275, 0.325, 0.2]], atol=1e-15)
    assert np.allclose(reached.yaw, [0.3, 0.0])


def test_the_velocity_of_the_tool_is_that_of_finite_differences() -> None:
    rng = np.random.default_rng(3)
    q, qd, step = rng.uniform(-2, 2, (100, 4)), rng.normal(size=(100, 4)), 1e-6
    after, before = tool(q + step * qd, qd), tool(q - step * qd, qd)
    now = tool(q, qd)
    assert np.allclose((after.position - before.position) / (2 * step), now.velocity, atol=1e-8)
    assert np.allclose((after.yaw - before.yaw) / (2 * step), now.yaw_rate, atol=1e-8)


def test_goals_and_obstacles_without_a_velocity_stand_still() -> None:
    problem = {
        "goal": {"pos": [0.1, 0.2, 0.3], "yaw": 0.4},
        "obstacles": [{"type": "cylinder", "radius": 0.1, "height": 0.2, "pos": [1.0, 2.0, 0.1], "yaw": 0.0}],
    }
    position, yaw, velocity = goal_at(problem, 3.0)
    assert (position.tolist(), yaw, velocity.tolist()) == ([0.1, 0.2, 0.3], 0.4, [0.0, 0.0, 0.0])
    (post,) = placed_obstacles(problem, np.array([0.0, 3.0]))
    assert np.ptp(post.centre, axis=0).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "obstacle",
    [{"type": "cone", "pos": [0, 0, 0], "yaw": 0}, {"type": "box", "size": [1, 1, 1], "motion": {"kind": "jump"}}],
)
def test_an_obstacle_of_an_unknown_kind_is_refused(obstacle: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="unknown"):
        placed_obstacles({"obstacles": [obstacle]}, np.zeros(1))
