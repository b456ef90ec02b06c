"""Contract tests: every law that exists is found by itself and must bear all of this."""

from __future__ import annotations

import inspect
import itertools
import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking import lawentry, lawsource, selection
from flocking.errors import InputError
from flocking.lawentry import Law
from flocking.parameters import Relation, declared
from flocking.perception import Step
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Floats, Kind, Motion
from tests.flocking.law_worlds import (
    EVERYTHING,
    Inputs,
    Moved,
    Scene,
    World,
    ask,
    in_world,
    inputs,
    scenes,
    transformed,
)

LAWS = lawsource.names()
AXIS, CHIRAL = (
    {name for name in LAWS if getattr(lawentry.module_of(name), mark, False)} for mark in ("AXIS", "CHIRAL")
)
IN_THE_PLANE = [name for name in LAWS if name not in AXIS]
ROUNDING = 1e-9
"""Relative: a few dozen operations on positions of order 100, amplified by the steepest force in these scenes."""
SAME_OPERATIONS = 1e-12
"""Relative: compiled and plain code do the same operations in the same order, but for the last bits of functions."""
MIRROR_X, MIRROR_Y = np.diag([-1.0, 1.0]), np.diag([1.0, -1.0])
UNIT_ENDINGS = {"m": "_m", "m/s": "_m_s", "rad": "_rad", "s": "_s", "rad/s": "_rad_s"}


def _has_range(name: str) -> bool:
    """Whether no set of the law's reaches farther than some distance."""
    module = lawentry.module_of(name)
    known = declared(module.Parameters)
    values = {parameter: field.default for parameter, field in known.items()}
    steps = selection.parse_sets("all", lawentry.sets_of(module), known)
    return all(math.isfinite(selection.reach(each, values)) for each in steps)


WITH_RANGES = [name for name in LAWS if _has_range(name)]


@pytest.fixture(params=LAWS)
def law(request: pytest.FixtureRequest) -> Law:
    return lawentry.load(request.param)


def rotation(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def successive(law: Law, scene: Scene, change: Callable[[World], World], known: frozenset[str]) -> Iterator[Moved]:
    """What the focal member does in the changed world, and, remembering that, in the same one a moment later."""
    memory = np.zeros(law.memory)
    world = scene.world
    for _ in range(3 if law.memory else 1):
        seen = change(world)
        yield in_world(ask(law, inputs(law, scene, seen, known), memory), float(seen.headings[0]))
        turned = world.headings + world.turn_rates * scene.dt_s
        world = world._replace(positions=world.positions + world.velocities * scene.dt_s, headings=turned)


def _as_it_is(world: World) -> World:
    return world


def assert_same(found: Moved, expected: Moved, matrix: Floats, tolerance: float = ROUNDING) -> None:
    assert (found.kind, found.rule) == (expected.kind, expected.rule)
    turned = matrix @ expected.vector
    assert_allclose(found.vector, turned, rtol=0.0, atol=tolerance * (1.0 + np.hypot(*turned)))
    assert found.speed == pytest.approx(expected.speed, rel=tolerance, abs=tolerance)


def assert_transforms(law: Law, matrix: Floats, shift: Floats) -> None:
    for scene in scenes(law):
        here = successive(law, scene, _as_it_is, law.needs)
        there = successive(law, scene, lambda world: transformed(world, matrix, shift), law.needs)
        for before, after in zip(here, there, strict=True):
            assert_same(after, before, matrix)


def assert_sound(law: Law, motion: Motion) -> None:
    assert motion.kind in list(Kind)
    assert 0 <= motion.rule < len(law.rules)
    if motion.kind not in (Kind.HOLD, Kind.STOP):
        assert math.isfinite(motion.x)
        assert math.isfinite(motion.y)


def permuted(given: Inputs, order: np.ndarray) -> Inputs:
    members = type(given.members)(*(np.ascontiguousarray(each[order]) for each in given.members))
    return given._replace(members=members, sets=np.ascontiguousarray(given.sets[:, order]))


def pair(law: Law, scene: Scene, gap: float, bearing: float) -> Inputs:
    """One neighbour at exactly that distance, everything else as in the scene."""
    world = _first(scene.world, 2)
    world = world._replace(headings=np.array([0.0, 1.0]), positions=np.zeros((2, 2)))
    world.positions[1] = gap * math.cos(bearing), gap * math.sin(bearing)
    return inputs(law, scene, world)


def _first(world: World, count: int) -> World:
    """The same world with its first members only."""
    kept = {name: getattr(world, name)[:count].copy() for name in World._fields if name not in ("obstacles", "u")}
    return world._replace(**kept | {"graph": world.graph[:count, :count].copy()})


class TestSame:
    """What must not make a difference, or only the difference that is made to the world."""

    def test_order_of_neighbours(self, law: Law) -> None:
        rng = np.random.default_rng(1)
        for scene in scenes(law):
            given = inputs(law, scene)
            order = rng.permutation(len(given.members.ids))
            assert_same(in_world(ask(law, permuted(given, order)), 0.0), in_world(ask(law, given), 0.0), np.eye(2))

    def test_order_of_equally_near_neighbours(self, law: Law) -> None:
        for scene in scenes(law):
            if len(scene.world.positions) < 5:
                continue
            reach = 0.5 * scene.spacing_m
            ring = reach * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
            world = _first(scene.world, 5)
            given = inputs(law, scene, world._replace(positions=ring, headings=np.r_[0.0, world.headings[1:]]))
            first = in_world(ask(law, given), 0.0)
            for turn in range(1, 4):
                assert_same(in_world(ask(law, permuted(given, np.roll(np.arange(4), turn))), 0.0), first, np.eye(2))

    def test_shifting_the_world(self, law: Law) -> None:
        assert_transforms(law, np.eye(2), np.array([12.0, -7.0]))

    @pytest.mark.parametrize("angle", [0.7, 2.6, -1.9])
    @pytest.mark.parametrize("law", IN_THE_PLANE, indirect=True)
    def test_turning_the_world_turns_the_motion(self, law: Law, angle: float) -> None:
        assert_transforms(law, rotation(angle), np.array([12.0, -7.0]))

    @pytest.mark.parametrize("law", [name for name in LAWS if name not in CHIRAL], indirect=True)
    def test_mirroring_the_world_mirrors_the_motion(self, law: Law) -> None:
        assert_transforms(law, MIRROR_X if law.axis else MIRROR_Y, np.array([3.0, 5.0]))

    def test_members_that_no_set_holds(self, law: Law) -> None:
        rng = np.random.default_rng(2)
        for scene in scenes(law):
            given = inputs(law, scene)
            given = given._replace(sets=given.sets & (rng.random(len(given.members.ids)) < 0.6))
            held = given.sets.any(axis=0)
            only = permuted(given, np.flatnonzero(held))
            # the law finds them in the same order, so that not even rounding may differ
            assert_same(in_world(ask(law, given), 0.0), in_world(ask(law, only), 0.0), np.eye(2), tolerance=0.0)

    def test_compiled_or_plain(self, law: Law) -> None:
        for scene in scenes(law):
            given = inputs(law, scene)
            compiled, plain = np.zeros(law.memory), np.zeros(law.memory)
            for _ in range(2):
                found = in_world(ask(law, given, compiled), 0.0)
                assert_same(found, in_world(ask(law, given, plain, plain=True), 0.0), np.eye(2), SAME_OPERATIONS)
                assert_allclose(compiled, plain, rtol=SAME_OPERATIONS, atol=SAME_OPERATIONS)

    def test_what_it_does_not_say_that_it_needs(self, law: Law) -> None:
        for scene in scenes(law):
            told, needed = (ask(law, inputs(law, scene, known=known)) for known in (EVERYTHING, law.needs))
            assert_same(in_world(told, 0.0), in_world(needed, 0.0), np.eye(2), tolerance=0.0)

    def test_asking_twice(self, law: Law) -> None:
        for scene in scenes(law):
            given, kept = inputs(law, scene), inputs(law, scene)
            first = ask(law, given)
            for one, other in zip(
                (*given.members, *given[2:4], given.u), (*kept.members, *kept[2:4], kept.u), strict=True
            ):
                np.testing.assert_array_equal(one, other)  # nothing of what it is given was written to
            assert ask(law, kept) == pytest.approx(first, rel=0.0, abs=0.0, nan_ok=True)


class TestLimits:
    """Finite and well-formed motions, whatever the neighbours do."""

    def test_random_worlds(self, law: Law) -> None:
        for scene in scenes(law):
            memory = np.zeros(law.memory)
            for _ in range(3):
                assert_sound(law, ask(law, inputs(law, scene), memory))

    def test_no_neighbours(self, law: Law) -> None:
        for scene in scenes(law):
            for goal in (np.full((1, 2), np.nan), scene.world.positions[:1], scene.world.positions[:1] + 3.0):
                for velocity in (0.0, 1.0):
                    world = _first(scene.world, 1)
                    world = world._replace(goals=goal, velocities=velocity * world.velocities)
                    assert_sound(law, ask(law, inputs(law, scene, world)))

    @pytest.mark.parametrize("factor", [1e-9, 1e6])
    def test_neighbours_very_near_and_very_far(self, law: Law, factor: float) -> None:
        for scene in scenes(law):
            world = scene.world._replace(positions=factor * scene.world.positions)
            assert_sound(law, ask(law, inputs(law, scene, world)))

    @pytest.mark.parametrize("where", ["on the focal member", "elsewhere", "all but on the focal member"])
    def test_coincident_neighbours(self, law: Law, where: str) -> None:
        offset = {"on the focal member": 0.0, "elsewhere": 0.4, "all but on the focal member": 1e-12}[where]
        for scene in scenes(law):
            positions = np.repeat(scene.world.positions[:1], len(scene.world.positions), axis=0)
            positions[1:, 0] += offset * scene.spacing_m
            for velocities in (scene.world.velocities, np.repeat(scene.world.velocities[:1], len(positions), axis=0)):
                world = scene.world._replace(positions=positions, velocities=velocities, obstacles=positions[:1])
                assert_sound(law, ask(law, inputs(law, scene, world)))

    def test_one_neighbour_on_either_side_of_every_distance_that_it_knows(self, law: Law) -> None:
        fields = declared(law.module.Parameters)
        for scene in (scenes(law)[0], scenes(law)[-1]):
            values = scene.parameters._asdict()
            for distance in {values[name] for name, field in fields.items() if field.about.unit == "m"} | {5.6}:
                for gap in (distance * (1.0 - 1e-9), distance, distance * (1.0 + 1e-9)):
                    for bearing in (0.0, 0.5 * math.pi, math.pi, -2.0):
                        assert_sound(law, ask(law, pair(law, scene, gap, bearing)))

    def test_draws_of_both_ends(self, law: Law) -> None:
        for scene in scenes(law):
            for end in (0.0, np.nextafter(1.0, 0.0)):
                assert_sound(law, ask(law, inputs(law, scene, scene.world._replace(u=np.full(law.draws, end)))))

    @pytest.mark.parametrize("law", WITH_RANGES, indirect=True)
    def test_a_neighbour_beyond_the_range_of_all_sets_is_nobody(self, law: Law) -> None:
        steps = selection.parse_sets("all", law.sets, law.parameter_names)
        for scene in (scenes(law)[0], scenes(law)[-1]):
            values = scene.parameters._asdict()
            farthest = max(selection.reach(each, values) for each in steps)
            beyond = pair(law, scene, farthest * (1.0 + 1e-9), bearing=0.6)
            assert not beyond.sets.any()
            alone = in_world(ask(law, permuted(beyond, np.arange(0))), 0.0)
            assert_same(in_world(ask(law, beyond), 0.0), alone, np.eye(2), tolerance=0.0)
            if all(step.step is Step.DISTANCE_BASED for each in steps for step in each):
                assert pair(law, scene, farthest * (1.0 - 1e-9), bearing=0.6).sets.any()


def breaking(law: Law, relation: Relation) -> dict[str, float]:
    """Values within their bounds that break this relation of the law and no other."""
    known = declared(law.module.Parameters)
    others = [each for each in lawentry.relations_of(law.module) if each != relation]
    tried = []
    for name in relation.names:
        about, usual = known[name].about, known[name].default
        values = (about.low, about.high, usual, 0.01 * usual, 100.0 * usual, 1.0)
        tried.append([value for value in values if math.isfinite(value) and about.low <= value <= about.high])
    for values in itertools.product(*tried):
        given = dict(zip(relation.names, values, strict=True))
        made = law.module.Parameters(**given)
        if not relation.holds(made) and all(each.holds(made) for each in others):
            return given
    raise AssertionError(f"nothing breaks {relation.words}")


class TestDeclares:
    """What a law's file says about itself."""

    def test_it_reads_what_it_says_that_it_needs(self, law: Law) -> None:
        for need in law.needs:
            assert any(self.differs(law, scene, need) for scene in scenes(law)), need

    @staticmethod
    def differs(law: Law, scene: Scene, need: str) -> bool:
        told = [(*motion[:2], *motion.vector, motion.speed) for motion in successive(law, scene, _as_it_is, law.needs)]
        try:
            found = successive(law, scene, _as_it_is, law.needs - {need})
            untold = [(*motion[:2], *motion.vector, motion.speed) for motion in found]
        except (ValueError, ZeroDivisionError, SystemError):
            return True
        return any(one != pytest.approx(other, nan_ok=True) for one, other in zip(told, untold, strict=True))

    def test_sources(self, law: Law) -> None:
        assert "Source:" in (law.module.__doc__ or "")
        assert len(set(law.rules)) == len(law.rules) >= 1
        for name, field in declared(law.module.Parameters).items():
            assert field.about.source, name
            assert field.about.low <= field.default <= field.about.high, name
            ending = UNIT_ENDINGS.get(field.about.unit)
            assert ending is None or name.endswith(ending), f"{name} in {field.about.unit}"
        law.parameters({name: field.default for name, field in declared(law.module.Parameters).items()})

    @pytest.mark.parametrize("law", sorted(AXIS), indirect=True)
    def test_its_motion_is_on_the_axis(self, law: Law) -> None:
        moved = [in_world(ask(law, inputs(law, scene)), float(scene.world.headings[0])) for scene in scenes(law)]
        assert max(np.hypot(*motion.vector) for motion in moved) > 0.0
        for motion in moved:
            assert abs(motion.vector[1]) <= ROUNDING * np.hypot(*motion.vector)

    def test_rows_of_the_taxonomies(self, law: Law) -> None:
        taxonomy, validation = law.module.TAXONOMY, law.module.VALIDATION
        assert isinstance(taxonomy, Taxonomy)
        assert taxonomy.composition in ("homogeneous", "heterogeneous")
        assert taxonomy.mobility in ("idealized", "constrained")
        assert taxonomy.time in ("discrete", "continuous")
        assert taxonomy.collision_avoidance in ("-", "member", "environment", "all")
        assert all(isinstance(column, bool) for column in taxonomy[4:])
        assert isinstance(validation, Validation)
        assert validation.method in ("M", "S", "P", "MS", "MP", "SP", "MSP", "-")
        assert isinstance(validation.synchronous, bool)
        assert set(validation[2:5]) <= {"global", "local", "inferred", "constant", "-"}
        spaces = ("unbounded free", "bounded free", "periodic free", "bounded obstacles", "unbounded obstacles", "-")
        assert validation.environment in spaces

    def test_what_was_filled_in(self, law: Law) -> None:
        stages = ("sensing", "member detection", "neighbour selection", "motion computation", "physical motion")
        for each in law.module.FILLED:
            assert isinstance(each, Filled)
            assert each.stage in stages
            assert each.left_open.strip()
            assert each.reading.strip()

    def test_its_kinematic_herd(self, law: Law) -> None:
        herd = law.module.HERD
        assert isinstance(herd, Herd)
        assert 0.0 < herd.spacing_m < math.inf
        assert 0.0 <= herd.speed_m_s < math.inf
        assert 0.0 < herd.dt_s < math.inf
        assert herd.space in ("unbounded", "bounded", "periodic")
        assert (herd.leaders > 0) == ("own.role" in inspect.getsource(law.module))

    def test_its_parameters_for_creates(self, law: Law) -> None:
        given = law.module.CREATE
        parameters = law.parameters(given)._asdict()
        assert {name: parameters[name] for name in given} == given
        assert all(parameters[name] <= 0.5 for name in parameters if name.endswith("speed_m_s"))

    def test_what_its_relations_rule_out_is_refused(self, law: Law) -> None:
        """The defaults and the values for Creates keep to them: the tests above would fail otherwise."""
        for relation in lawentry.relations_of(law.module):
            given = breaking(law, relation)
            with pytest.raises(InputError) as refused:
                law.parameters(given)
            said = str(refused.value)
            assert said.startswith(f"law {law.name!r}: ")
            assert said.endswith(f": expected {relation.words}")
            assert all(f"law.{name} = {given[name]!r}" in said for name in relation.names)
            assert "\n" not in said

    def test_its_sets(self, law: Law) -> None:
        steps = selection.parse_sets("all", law.sets, law.parameter_names)
        assert len(steps) == len(law.sets) >= 1
        assert all(text.strip() for text in law.sets.values())
