"""What stops a kinematic herd: laws that fail in it, Ctrl-C, and what does not fit, which is refused."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.errors import InputError
from flocking.kinematic import Band, LawFailedError, Schedule, Space, simulate
from tests.flocking.kinematic.herds import SQUARE, TOLD, law_of, poses, run, told

ROOT = Path(lawentry.__file__).parents[1]
HEARD_S = 0.5
"""Kernels return to Python at least so often."""


def broken(line: str, above: str = "") -> str:
    return TOLD.replace("    memory[0] += 1.0\n", f"    {line}\n") + above


class TestFailingLaws:
    @pytest.mark.parametrize(
        ("line", "said"),
        [
            ("x = math.nan if own.id == 3 and memory[0] > 0.0 else x", "x nan"),
            ("y = math.inf if own.id == 3 and memory[0] > 0.0 else y", "y inf"),
            ("x = -1e308 * 1e10 * (1.0 if own.id == 3 and memory[0] > 0.0 else 0.0) if own.id == 3 else x", ""),
        ],
    )
    @pytest.mark.parametrize("synchronous", [True, False])
    @pytest.mark.parametrize("bands", [1, 2])
    def test_numbers_that_are_none(self, line: str, said: str, synchronous: bool, bands: int) -> None:
        law = law_of(broken(line + "\n    memory[0] += 1.0"))
        group = [Band(law, 5)] if bands == 1 else [Band(law, 2), Band(law, 3)]
        step = 1 if said == "" else 2
        with pytest.raises(
            LawFailedError, match=rf"law '/made/up/told.py' returned .*member 4 at step {step};"
        ) as error:
            run(group, poses(np.zeros((5, 2))), 10, synchronous=synchronous)
        assert said in str(error.value)
        assert "\n" not in str(error.value)

    @pytest.mark.parametrize("kind", [-1, 6, 1000])
    @pytest.mark.parametrize("obstacles", ["as-law", "avoid"])
    def test_kinds_that_there_are_not(self, kind: int, obstacles: str) -> None:
        """Avoidance does not make a motion of what is none: a wall stands in the way."""
        space = Space(walls=np.array([[0.5, -5.0, 0.5, 5.0]]))
        with pytest.raises(LawFailedError, match=rf"returned kind {kind}, .*member 1 at step 1; expected a kind"):
            run(told(1, {"kind": kind, "x": 1.0}, obstacles=obstacles), poses([[0.0, 0.0]]), 3, space=space)

    @pytest.mark.parametrize(
        ("line", "said"),
        [
            ("x += members.positions[len(members.ids), 0]", "IndexError"),
            ("x += members.positions[-1 - len(members.ids), 0]", "IndexError"),
            ("x += sets[1, 0]", "IndexError"),
            ("x += u[2]", "IndexError"),
            ("memory[1] = 1.0", "IndexError"),
            ("memory[10**6] = 1.0", "IndexError"),
            ("x = x / (own.id - own.id)", "ZeroDivisionError"),
            ("raise ValueError('this is not\\n for me')", "ValueError: this is not for me"),
            ("assert own.id < 0, 'never'", "AssertionError"),
        ],
    )
    @pytest.mark.parametrize("synchronous", [True, False])
    def test_errors_name_law_member_and_step(self, line: str, said: str, synchronous: bool) -> None:
        law = law_of(broken(f"memory[0] += 1.0\n    if own.id == 2 and memory[0] > 4.0:\n        {line}"))
        with pytest.raises(LawFailedError, match=r"law '/made/up/told.py' raised .* for member 3 at step 5$") as error:
            run(Band(law, 4), poses(np.zeros((4, 2))), 30, synchronous=synchronous)
        assert said in str(error.value)
        assert "\n" not in str(error.value)

    def test_laws_that_make_arrays_fail_likewise(self) -> None:
        law = law_of(
            broken("made = np.zeros(3)\n    x += made[own.id]").replace(
                "import math", "import math\nimport numpy as np", 1
            )
        )
        with pytest.raises(LawFailedError, match=r"raised IndexError.* for member 4 at step 1$"):
            run(Band(law, 5), poses(np.zeros((5, 2))), 2)
        assert np.isfinite(run(Band(law, 3), poses(np.zeros((3, 2))), 2).poses_w).all()


LONG = """
import sys, time
import numpy as np
from flocking import lawentry
from flocking.kinematic import Band, Schedule, simulate, start_uniform

name, count, every, synchronous = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4] == "together"
band = Band(lawentry.load(name), count)
start = start_uniform(count, 100.0, np.random.default_rng(0))
print("going", flush=True)
try:
    simulate(band, start, Schedule(0.1, 10**7, every, synchronous), rng=np.random.default_rng(0))
except KeyboardInterrupt:
    print(time.time(), flush=True)
"""


class TestInterrupt:
    @pytest.mark.parametrize(
        ("law", "count", "every", "order"),
        [
            ("vicsek", 1000, 10**6, "together"),
            ("vicsek", 1000, 10**6, "in turn"),
            ("gregoire-1", 100, 10**6, "together"),
            ("gazi-passino-2003", 20_000, 10**6, "together"),
            ("gazi-passino-2003", 20_000, 10**6, "in turn"),
        ],
    )
    def test_is_heard_within_half_a_second(self, law: str, count: int, every: int, order: str) -> None:
        """Also where a record lies a million steps ahead, and where a single step takes seconds: all see all."""
        process = subprocess.Popen(
            [sys.executable, "-c", LONG, law, str(count), str(every), order],
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            text=True,
        )
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == "going\n"
            time.sleep(2.0)
            assert process.poll() is None
            at = time.time()
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=60.0)
        finally:
            process.kill()
        assert float(out) - at < HEARD_S


class TestBadInput:
    @pytest.mark.parametrize(
        ("change", "said"),
        [
            ({"space": Space("round", 3.0)}, "space 'round': expected unbounded or bounded or periodic"),
            ({"space": Space("bounded")}, "bounded space of side inf m"),
            ({"space": Space("periodic", 0.0)}, "periodic space of side 0 m"),
            ({"space": Space("periodic", -1.0)}, "periodic space of side -1 m"),
            ({"space": Space("bounded", math.nan)}, "bounded space of side nan m"),
            ({"space": Space(walls=np.zeros(4))}, r"walls of shape \(4,\)"),
            ({"space": Space(walls=np.zeros((2, 3)))}, r"walls of shape \(2, 3\)"),
            ({"space": Space(walls=np.full((1, 4), np.nan))}, "finite numbers"),
            ({"space": Space("bounded", 1.0)}, r"member 3 starts at 2, 2, outside of the bounded space"),
            ({"schedule": Schedule(0.0, 2)}, "dt_s = 0"),
            ({"schedule": Schedule(math.nan, 2)}, "dt_s = nan"),
            ({"schedule": Schedule(math.inf, 2)}, "dt_s = inf"),
            ({"schedule": Schedule(0.1, -1)}, "steps = -1"),
            ({"schedule": Schedule(0.1, 2, every=0)}, "every = 0"),
            ({"poses_w": np.zeros((2, 3))}, r"starting poses of shape \(2, 3\) for 3 members"),
            ({"poses_w": np.zeros((3, 2))}, r"starting poses of shape \(3, 2\) for 3 members"),
            ({"poses_w": np.zeros(9)}, r"starting poses of shape \(9,\)"),
            ({"poses_w": np.array([[0.0, 0, 0], [0, np.nan, 0], [0, 0, 0]])}, "starting pose 2 is not finite"),
            ({"poses_w": np.array([[0.0, 0, 0], [0, 0, 0], [0, 0, np.inf]])}, "starting pose 3 is not finite"),
            ({"velocities_w": np.zeros((2, 2))}, r"velocities of shape \(2, 2\) for 3 members"),
            ({"velocities_w": np.full((3, 2), np.nan)}, "starting velocity of member 1 is not finite"),
            ({"speeds_m_s": np.zeros(2)}, r"speeds of shape \(2,\) for 3 members"),
            ({"speeds_m_s": math.inf}, "a starting speed is inf"),
            ({"speeds_m_s": np.array([0.0, math.nan, 1.0])}, "a starting speed is nan"),
            ({"graph": np.ones((2, 2), dtype=bool)}, r"graph of shape \(2, 2\) for 3 members"),
            ({"graph": np.ones(3, dtype=bool)}, r"graph of shape \(3,\) for 3 members"),
            ({"bands": []}, "no bands|for 0 members"),
            ({"bands": [told(4), told(-1)]}, "-1 members of law"),
            ({"bands": [told(3), told(0)]}, "0 members of law"),
            ({"bands": told(3, [{}, {}])}, "2 sets of parameters for 3 members of law"),
            ({"bands": told(3, {"see": -1.0})}, "see = -1.0: expected a finite number of at least 0 in m"),
            ({"bands": told(3, [{}, {"se": 1.0}, {}])}, "unknown parameter 'law.se'; did you mean law.see"),
            ({"bands": told(3, selection="k-nearest(0)")}, r"k-nearest\(0\)'.*a whole number of at least 1"),
            ({"bands": told(3, selection="k-nearest(see)")}, None),
            ({"bands": told(3, {"see": 1.5}, selection="k-nearest(see)")}, "a whole number of at least 1"),
            ({"bands": told(3, selection="farthest")}, "unknown selection 'farthest'"),
            ({"bands": told(3, selection="others: all")}, "unknown set of the law 'others'; did you mean|valid"),
            ({"bands": told(3, selection="nearest & voronoi")}, "voronoi must come first"),
            ({"bands": told(3, selection="neighbours: nearest & voronoi")}, "voronoi must come first"),
            ({"bands": told(3, selection="fixed-set")}, "this herd has no graph"),
            ({"bands": told(3, detection="laser")}, "detection = 'laser': expected perfect or member-based"),
            ({"bands": told(3, information="smell")}, "information = 'smell': expected poses or bearings"),
            ({"bands": told(3, obstacles="ignore")}, "obstacles = 'ignore': expected as-law or avoid"),
            ({"bands": told(3, max_speed_m_s=-1.0)}, "max_speed_m_s = -1"),
            ({"bands": told(3, max_turn_rate_rad_s=math.nan)}, "max_turn_rate_rad_s = nan"),
            ({"bands": told(3, radius_m=-0.1)}, "radius_m = -0.1"),
            ({"bands": told(3, radius_m=math.inf)}, "radius_m = inf"),
            ({"bands": told(3, cruise_m_s=math.nan)}, "cruise_m_s = nan"),
            ({"bands": told(3, sight_m=-1.0)}, "sight_m = -1"),
            ({"bands": told(3, assumed_distance_m=math.inf)}, "assumed_distance_m = inf"),
            ({"bands": told(3, silhouette_m=math.nan)}, "silhouette_m = nan"),
            ({"bands": told(3, goals_w=np.zeros((2, 2)))}, r"goals of shape \(2, 2\)"),
            ({"bands": told(3, goals_w=np.full((3, 2), np.inf))}, "nan for none"),
        ],
    )
    def test_is_refused_in_one_line(self, change: dict[str, Any], said: str | None) -> None:
        given: dict[str, Any] = {
            "bands": told(3),
            "poses_w": poses([[0.0, 0.0], [1.0, 0.5], [2.0, 2.0]]),
            "schedule": Schedule(0.1, 2),
            "rng": np.random.default_rng(0),
            **change,
        }
        if said is None:
            assert len(simulate(**given).times) == 3
            return
        with pytest.raises(InputError, match=said) as error:
            simulate(**given)
        assert "\n" not in str(error.value)

    def test_a_bounded_square_may_be_filled_to_its_border(self) -> None:
        assert len(run(told(2), poses([[0.0, 0.0], [10.0, 10.0]]), 1, space=SQUARE).times) == 2
