"""Contract tests: every body is found by its folder, and is what it says."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

import robots
from flocking.errors import InputError
from flocking.types import Kind
from robots import body as bodies
from robots import physics
from robots.body import Body

NAMES = bodies.names()
DT = 0.1
WHEELED = [name for name in NAMES if any(geom.name.endswith("_tyre") for geom in bodies.load(name).spec().geoms)]
"""Bodies that stand still by themselves and roll."""


@pytest.fixture(params=NAMES)
def body(request: pytest.FixtureRequest) -> Body:
    return bodies.load(request.param)


@pytest.fixture(params=WHEELED)
def wheeled(request: pytest.FixtureRequest) -> Body:
    return bodies.load(request.param)


class Alone:
    """One robot of a kind on a floor."""

    def __init__(self, body: Body) -> None:
        self.model = bodies.scene(body).compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.fleet = body.fleet(self.model, [""])

    def run(self, seconds: float) -> float:
        """Its greatest speed over ground in that time, m/s."""
        fastest = 0.0
        for _ in range(round(seconds / self.model.opt.timestep)):
            self.fleet.before_step(self.data)
            mujoco.mj_step(self.model, self.data)
            self.fleet.after_step(self.data)
            fastest = max(fastest, float(np.hypot(*self.fleet.velocities(self.data)[0])))
        assert self.data.warning.number.sum() == 0, "MuJoCo warned"
        return fastest


def test_every_folder_with_a_body_is_found() -> None:
    home = Path(str(robots.__file__)).parent
    told = {path.parent.name for path in home.glob("*/__init__.py") if "BODY" in path.read_text(encoding="utf-8")}
    assert {name.replace("-", "_") for name in NAMES} == told
    assert {"create", "create-small", "create-with-cameras", "pioneer", "one-legged"} <= set(NAMES)
    assert set(NAMES) - set(WHEELED) == {"one-legged"}


def test_names_may_have_hyphens_or_underscores_and_the_nearest_is_offered() -> None:
    assert bodies.load("create_small") is bodies.load("create-small")
    with pytest.raises(InputError, match="create-small"):
        bodies.load("create-smal")
    with pytest.raises(InputError, match="unknown body 'physics'"):
        bodies.load("physics")


def test_an_absent_sensor_is_refused_in_one_line(body: Body) -> None:
    with pytest.raises(InputError, match=f"body '{body.name}' carries no nose; expected one that does"):
        body.mount("nose")


def test_its_name_is_its_folders(body: Body, request: pytest.FixtureRequest) -> None:
    assert body.name == request.node.callspec.params["body"]


def test_its_xml_is_what_the_code_makes_and_loads_alone(body: Body) -> None:
    path = bodies.xml_path(body.name)
    assert path.read_text(encoding="utf-8") == bodies.xml(body)
    assert mujoco.MjModel.from_xml_path(str(path)).nq == body.spec().compile().nq


def test_without_its_looks_it_moves_as_the_whole_one_does(body: Body) -> None:
    """Bit for bit: driven about with a wheel now against, now off a wall."""
    ends, counts = [], []
    for strip in (lambda robot: robot, physics.bare):
        spec = mujoco.MjSpec()
        physics.apply_options(spec)
        plane, box = mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_BOX
        spec.worldbody.add_geom(type=plane, size=(0, 0, 1), contype=physics.FLOOR_MASK, conaffinity=0)
        mask = {"contype": physics.HULL_MASK, "conaffinity": physics.HULL_MASK}
        spec.worldbody.add_geom(type=box, size=(0.1, 2.0, 0.25), pos=(0.5, 0.0, 0.25), **mask)
        for k in range(2):
            spec.attach(strip(body.spec()), prefix=f"{k}/", frame=spec.worldbody.add_frame(pos=(0.0, k, 0.0)))
        model = spec.compile()
        data = mujoco.MjData(model)
        rng, rows = np.random.default_rng(4), []
        for _ in range(20):
            data.ctrl[:] = rng.uniform(-3.0, 12.0, model.nu)
            mujoco.mj_step(model, data, 25)
            rows.append(np.concatenate([data.qpos, data.qvel]))
        ends.append(np.array(rows))
        counts.append((model.nbody, model.njnt, model.nu, model.ngeom))
        assert data.ncon > 0
    np.testing.assert_array_equal(*ends)
    assert counts[0][:3] == counts[1][:3]
    assert counts[1][3] < counts[0][3]


def test_its_constants_stand_in_modules_that_exist(body: Body) -> None:
    from trials.commands.constants import constants

    told = constants(body.constants)
    assert len(told) > 20
    assert all(constant.remark for constant in told)


def test_it_rests_where_it_is_put(wheeled: Body) -> None:
    """At z = 0 and upright, to a hundredth of what a laser reads (a millimetre)."""
    alone = Alone(wheeled)
    alone.run(3.0)
    np.testing.assert_allclose(alone.data.qpos[:3], 0.0, atol=1e-5)
    np.testing.assert_allclose(alone.data.qpos[4:6], 0.0, atol=1e-5)


def test_tyres_are_pressed_in_by_their_margins(wheeled: Body) -> None:
    """By (1 − d) A N / K under the load N, to a hundredth: so each wheel rolls on its nominal radius."""
    alone = Alone(wheeled)
    alone.run(3.0)
    model, data, force = alone.model, alone.data, np.empty(6)
    tyres = [c for c in range(data.ncon) if model.geom(data.contact[c].geom2).name.endswith("_tyre")]
    assert len(tyres) == sum(name.name.endswith("_tyre") for name in wheeled.spec().geoms) >= 2
    for c in tyres:
        mujoco.mj_contactForce(model, data, c, force)
        geom = data.contact[c].geom2
        stiffness, impedance = -model.geom_solref[geom, 0], model.geom_solimp[geom, 0]
        pressed = (1.0 - impedance) * model.body_invweight0[model.geom_bodyid[geom], 0] * force[0] / stiffness
        assert model.geom_margin[geom] == pytest.approx(pressed, rel=0.01)
        assert data.contact[c].dist == pytest.approx(0.0, abs=1e-5)


def test_its_mounts_stand_where_it_says(body: Body) -> None:
    model = body.spec().compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for mount in body.mounts.values():
        site = data.site(mount.site)
        assert site.xpos[2] == pytest.approx(mount.height_m, abs=1e-12)
        assert site.xmat[8] == pytest.approx(1.0)


def test_all_lasers_scan_one_plane() -> None:
    heights = {
        name: bodies.load(name).mounts["laser"].height_m for name in NAMES if "laser" in bodies.load(name).mounts
    }
    assert np.ptp(list(heights.values())) < 1e-9


def test_its_radius_is_its_hulls(body: Body) -> None:
    """The greatest distance from its axis of what meets walls: of a sphere or an upright capsule, the centre's distance
    and its radius."""
    model = body.spec().compile()
    hulls = np.flatnonzero((model.geom_contype | model.geom_conaffinity) & physics.HULL_MASK)
    assert len(hulls)
    round_ = (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE)
    assert np.isin(model.geom_type[hulls], round_).all()
    np.testing.assert_array_equal(model.geom_quat[hulls], [(1.0, 0.0, 0.0, 0.0)] * len(hulls))
    reach = np.hypot(*model.geom_pos[hulls, :2].T) + model.geom_size[hulls, 0]
    assert reach.max() == body.radius


def test_hulls_of_all_kinds_meet_at_their_equators() -> None:
    """Then two spheres touch where two upright cylinders would, whatever their sizes."""
    heights = set()
    for name in NAMES:
        model = bodies.load(name).spec().compile()
        hulls = np.flatnonzero(model.geom_contype & physics.HULL_MASK)
        heights |= set(model.geom_pos[hulls, 2].tolist())
    assert len(heights) == 1


def test_it_reaches_its_top_speed_and_no_more(wheeled: Body) -> None:
    """The wheels roll on their nominal radius to a thousandth; a command beyond the top speed is no faster."""
    for wanted in (wheeled.top_speed, 2.0 * wheeled.top_speed):
        alone = Alone(wheeled)
        alone.fleet.command(0, wanted, 0.0)
        assert alone.run(4.0) == pytest.approx(wheeled.top_speed, rel=5e-3)


@pytest.mark.parametrize("kind", list(Kind))
def test_what_it_follows_stays_within_its_limits(body: Body, kind: Kind) -> None:
    """Whatever a law wants, from whatever command: never faster than the top speed, on neither side."""
    if kind not in body.follows:
        pytest.skip(f"{body.name} does not follow {kind.name}")
    rng = np.random.default_rng(int(kind))
    for _ in range(200):
        x, y = rng.normal(0.0, 3.0, 2)
        now = rng.uniform(-0.5, 1.0) * body.top_speed, 0.0
        speed, turn_rate = body.follow(int(kind), float(x), float(y), 2.0 * body.top_speed, *now, DT)
        assert math.isfinite(turn_rate)
        assert abs(speed) <= body.top_speed * (1.0 + 1e-12)


def test_it_goes_to_a_way_point(body: Body) -> None:
    alone, command, cruise = Alone(body), (0.0, 0.0), body.top_speed / 2.0
    goal = np.array([0.6, 0.5])
    for _ in range(round(np.hypot(*goal) / cruise / DT) + 50):
        x, y, heading = alone.fleet.poses(alone.data)[0]
        dx, dy = goal - (x, y)
        c, s = math.cos(heading), math.sin(heading)
        command = body.follow(int(Kind.WAY_POINT), c * dx + s * dy, c * dy - s * dx, cruise, *command, DT)
        alone.fleet.command(0, *command)
        alone.run(DT)
    assert np.hypot(*(alone.fleet.poses(alone.data)[0, :2] - goal)) < body.radius / 2.0
