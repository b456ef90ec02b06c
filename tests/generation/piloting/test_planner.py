"""The planner with a group whose ways are known: straight on, and along whatever wall is in the way."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from numba import njit

from flocking.errors import InputError
from flocking.types import Floats
from generation.group import Job
from generation.piloting import chain, planner, static
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from generation.piloting.plan import Plan, Wall
from generation.piloting.planner import BudgetSpentError, Grid, Progress, Search

STEP_M = 0.1
COARSE = Grid(angle_step_deg=45.0, lengths_m=(2.12,))
"""The diagonals of crossings, and walls across streets."""
HOW = Search(grid=COARSE, starts=2, side_m=0.2, apart_m=0.0, share=1.0)


class Sliding:
    """One member that goes straight on, and along a wall that its next steps would cross, by the lesser turn."""

    count = 1

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        for job in jobs:
            x, y, heading = job.poses_w[0]
            yield _slid(job.environment.walls(), float(x), float(y), float(heading), iterations)[:, None]


@njit
def _slid(walls: Floats, x: float, y: float, heading: float, iterations: int) -> Floats:  # pragma: no cover
    found = np.empty((iterations + 1, 2))
    found[0] = x, y
    for k in range(iterations):
        turned = False
        for _ in range(4):
            met = _met(walls, x, y, 2.0 * STEP_M * math.cos(heading), 2.0 * STEP_M * math.sin(heading))
            if met < 0:
                turned = True
                break
            along = math.atan2(walls[met, 3] - walls[met, 1], walls[met, 2] - walls[met, 0])
            one = (along - heading + math.pi) % (2.0 * math.pi) - math.pi
            other = (along + 2.0 * math.pi - heading) % (2.0 * math.pi) - math.pi
            heading += one if abs(one) <= abs(other) else other
        if not turned:
            heading += math.pi
        x, y = x + STEP_M * math.cos(heading), y + STEP_M * math.sin(heading)
        found[k + 1] = x, y
    return found


@njit
def _met(walls: Floats, x: float, y: float, dx: float, dy: float) -> int:  # pragma: no cover
    """The first of the walls that a step crosses; −1 = none."""
    for k in range(len(walls)):
        ex, ey = walls[k, 2] - walls[k, 0], walls[k, 3] - walls[k, 1]
        ox, oy = walls[k, 0] - x, walls[k, 1] - y
        cross = dx * ey - dy * ex
        if cross == 0.0:
            continue
        part, along = (ox * ey - oy * ex) / cross, (ox * dy - oy * dx) / cross
        if 0.0 <= part <= 1.0 and 0.0 <= along <= 1.0:
            return k
    return -1


@pytest.mark.parametrize("name", tasks.names())
def test_candidates_begin_at_anchors_and_cross_no_wall(name: str) -> None:
    task = tasks.load(name)
    for turn in task.turns:
        found = planner.candidates(task, turn, Grid())
        assert found
        ends = {tuple(sorted([tuple(s[:2].round(3)), tuple(s[2:].round(3))])) for s in (w.segment(task) for w in found)}
        assert len(ends) == len(found)  # none is tried from both of its ends
        for wall in found:
            segment = wall.segment(task)
            assert np.allclose(segment[:2], task.anchors[wall.anchor])
            # rounding of the ends, which may lie on the walls of blocks
            assert np.hypot(*(segment[2:] - task.trajectory[turn])) <= Grid().reach_m + 1e-9


@pytest.mark.parametrize("changing", [False, True])
def test_a_plan_is_found_for_a_staircase_and_guides_new_herds(changing: bool) -> None:
    task, group, progress = tasks.load("task-1"), Sliding(), Progress()
    plan = planner.search(task, group, STEP_M, HOW, static=not changing, progress=progress)
    assert len(plan.walls) == 3
    assert progress.simulations <= HOW.budget
    new = chain.starts(task, 1, 3, 99, 0.2, 0.0)
    last = chain.follow(task, plan, group, new, STEP_M)[-1]
    assert chain.share(last) == 1.0
    none = Plan(task.name, True, ())
    assert chain.share(chain.follow(task, none, group, new, STEP_M)[-1]) == 0.0  # without walls nobody arrives


def test_no_walls_that_stand_all_the_time_solve_the_loop_and_walls_that_change_do() -> None:
    task, group = tasks.load("task-3"), Sliding()
    states = chain.starts(task, 1, 2, 1, 0.2, 0.0)
    found = static.exhaust(task, group, states, STEP_M, 2.0 * STEP_M, COARSE)
    assert found.best == 0.0
    assert found.plan is None or len(found.plan.walls) == 5
    assert 0 < found.tried <= found.sets
    plan = planner.search(task, group, STEP_M, HOW)
    assert not plan.static
    assert len(plan.walls) == 5
    assert chain.share(chain.follow(task, plan, group, states, STEP_M)[-1]) == 1.0


def test_exhausting_the_sets_of_a_staircase_finds_one() -> None:
    task, group = tasks.load("task-1"), Sliding()
    states = chain.starts(task, 1, 2, 1, 0.2, 0.0)
    found = static.exhaust(task, group, states, STEP_M, 2.0 * STEP_M, COARSE)
    assert found.best == 1.0
    assert found.plan is not None
    assert chain.share(chain.follow(task, found.plan, group, states, STEP_M)[-1]) == 1.0


def test_a_budget_that_is_spent_keeps_the_longest_chain() -> None:
    task, progress = tasks.load("task-1"), Progress()
    with pytest.raises(BudgetSpentError, match="no plan within 30 simulations: the longest chain has"):
        planner.search(task, Sliding(), STEP_M, HOW._replace(budget=30), progress=progress)
    assert progress.best is None or len(progress.best.walls) < 3


def test_a_grid_without_a_plan_says_what_was_tried() -> None:
    with pytest.raises(InputError, match="no plan of changing walls in the grid: the longest chain has 0 of 3"):
        planner.search(
            tasks.load("task-1"), Sliding(), STEP_M, HOW._replace(grid=Grid(90.0, (0.3,), robots=1, radius_m=0.01))
        )
    with pytest.raises(InputError, match=r"no wall of the grid can stand at turn 1: expected an anchor within 1\.3 m"):
        planner.search(tasks.load("task-1"), Sliding(), STEP_M, HOW._replace(grid=Grid(90.0, (0.3,))))


def test_plans_stand_as_they_say_and_are_read_as_they_were_written(tmp_path: Path) -> None:
    walls = (Wall(27, 315.0, 0.75), Wall(22, 135.0, 0.75), Wall(45, 315.0, 0.75))
    changing = Plan("task-1", False, walls, (1.0, 0.95, 1.0))
    assert [changing.standing(passed) for passed in range(4)] == [(0, 1), (1, 2), (2,), ()]
    assert all(Plan("task-1", True, walls).standing(passed) == (0, 1, 2) for passed in range(4))
    path = tmp_path / "plan.json"
    path.write_text(plans.to_json(changing, {"simulations": 7}))
    assert plans.read(path) == changing


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": 2}', '{"format": 1, "task": 1, "static": true, "walls": []}']
)
def test_what_is_no_plan_is_refused_in_one_line(text: str) -> None:
    with pytest.raises(InputError, match="is no plan") as refused:
        plans.from_json(text, "mine.json")
    assert "\n" not in str(refused.value)


def test_a_wall_at_an_anchor_that_a_task_lacks_is_refused() -> None:
    with pytest.raises(InputError, match="anchors 1 to 64"):
        Wall(99, 0.0, 1.0).segment(tasks.load("task-1"))


def test_walls_in_words_come_back_as_they_were() -> None:
    walls = (Wall(27, 315.0, 0.75), Wall(1, 0.0, 2.12), Wall(45, 22.5, 1.06))
    assert plans.words(walls) == "27 315 0.75, 1 0 2.12, 45 22.5 1.06"
    assert plans.of_words(plans.words(walls)) == walls
    assert plans.of_words(" ") == plans.of_words("") == ()
    for name in tasks.names():
        assert plans.of_words(plans.words(plans.shipped(name).walls)) == plans.shipped(name).walls


@pytest.mark.parametrize(
    "text", ["27", "27 315", "27 315 0.75 1", "a 1 1", "1.5 1 1", "1 nan 1", "1 1 0", "1 1 inf", ","]
)
def test_words_that_are_no_walls_are_refused_in_one_line(text: str) -> None:
    with pytest.raises(InputError, match="expected its anchor, its angle in degrees and its length") as refused:
        plans.of_words(text)
    assert "\n" not in str(refused.value)


def test_a_wall_is_the_steadier_the_better_its_neighbours_in_the_grid_do() -> None:
    """Against means worked out by hand; a neighbour is one step of angle or length off, also past the full turn."""
    grid = Grid(angle_step_deg=90.0, lengths_m=(1.0, 2.0, 3.0))
    wall = Wall(1, 0.0, 1.0)
    shares = {
        wall: 1.0,
        Wall(1, 270.0, 1.0): 0.4,  # a step of angle
        Wall(1, 90.0, 2.0): 0.1,  # a step of each
        Wall(1, 180.0, 1.0): 0.9,  # two steps
        Wall(1, 0.0, 3.0): 0.8,
        Wall(2, 0.0, 1.0): 0.7,  # another anchor
    }
    assert planner.steadiness(wall, shares, grid) == pytest.approx((1.0 + 0.4 + 0.1) / 3)
    assert planner.steadiness(Wall(2, 0.0, 1.0), shares, grid) == 0.7


@pytest.mark.parametrize("changing", [False, True])
def test_a_search_goes_on_with_the_walls_that_were_found(changing: bool) -> None:
    task, group = tasks.load("task-1"), Sliding()
    whole = planner.search(task, group, STEP_M, HOW, static=not changing)
    begun = Plan(task.name, not changing, whole.walls[:2], whole.shares[:2])
    progress = Progress()
    found = planner.search(task, group, STEP_M, HOW, static=not changing, progress=progress, begun=begun)
    assert found.walls[:2] == begun.walls
    assert len(found.walls) == 3
    fresh = Progress()
    planner.search(task, group, STEP_M, HOW, static=not changing, progress=fresh)
    assert progress.simulations < fresh.simulations


def test_a_search_that_goes_on_gives_up_walls_from_which_none_goes_on() -> None:
    """The second wall is the first once more, and turns nobody: the search goes back to the first alone."""
    task, group = tasks.load("task-1"), Sliding()
    whole = planner.search(task, group, STEP_M, HOW)
    begun = Plan(task.name, False, whole.walls[:1] * 2, (1.0, 1.0))
    found = planner.search(task, group, STEP_M, HOW, begun=begun)
    assert len(found.walls) == 3
    assert found.walls[0] == begun.walls[0]
    assert found.walls[1] != begun.walls[1]
    progress = Progress()
    with pytest.raises(InputError):
        planner.search(task, group, STEP_M, HOW._replace(budget=1), progress=progress, begun=begun)
    assert progress.best == begun


def test_a_whole_plan_is_judged_by_new_herds_of_a_stated_number_and_its_interval_holds_their_share() -> None:
    task = tasks.load("task-1")
    found = planner.search(task, Sliding(), STEP_M, HOW._replace(herds=7), static=True)
    assert found.judged is not None
    assert (found.judged.herds, found.judged.share) == (7, 1.0)
    assert found.judged.low == pytest.approx(1.0 / (1.0 + 1.959964**2 / 7))  # Wilson 1927, where all arrive
    assert plans.from_json(plans.to_json(found), "here") == found
    half = plans.judged([0.0, 1.0] * 25)
    assert (half.low, half.high) == pytest.approx((0.366, 0.634), abs=5e-4)
