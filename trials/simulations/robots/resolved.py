"""A group of robots with its names looked up and its numbers checked and filled in."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any, NamedTuple

from flocking import avoidance, found, lawentry, obstacle_selection, selection
from flocking.errors import InputError
from flocking.parameters import declared, filled
from robots import body as bodies
from robots.body import Body
from sensing import association
from sensing.camera import imperfections, setting
from sensing.laser import hokuyo
from sensing.pipelines import INFERRED, OF_ITSELF, given_by
from trials.rows import below
from trials.simulations.robots.fields import (
    AS_LAW,
    ASSOCIATION,
    AVOIDANCE,
    CAMERAS,
    IMPERFECTIONS,
    PIPELINES,
    SENSORS,
    TWO_SCANS,
    GroupFields,
    of_group,
)
from trials.types import Group

LASER = frozenset({"scan", "intensity", "owners"})
"""What of a robot's senses comes from a laser."""
SONAR = "sonar"
"""Name of a ring of sonars among the mounts of a body."""


class Wanted(NamedTuple):
    """What a group's law and its selections need, and what its robots must do to have it."""

    needs: frozenset[str]
    of_each: frozenset[str]
    """Those without which a member is not handed on to the law."""
    missing: frozenset[str]
    """The needs that the pipeline does not meet."""
    inferable: frozenset[str]
    """Those of the missing that association can infer."""
    own_pose: bool
    """Whether a robot must keep its own pose up to date."""

    @property
    def associate(self) -> bool:
        """Whether velocities or headings are to be inferred."""
        return bool(self.inferable)


@dataclass(frozen=True)
class Resolved:
    """What the names and numbers of a group stand for.

    Each property is looked up when it is first read, and raises `InputError` for a name that does not exist or a number
    that does not fit.
    """

    group: Group

    @cached_property
    def given(self) -> GroupFields:
        """The group's fields with everything filled in."""
        return of_group(self.group)

    @cached_property
    def law(self) -> ModuleType:
        """The law's file."""
        return lawentry.module_of(self.group.law, self.group.law_source)

    @cached_property
    def law_parameters(self) -> Any:
        """The law's parameters on robots: the group's values, else those for Creates, else the law's own."""
        given = {**self.for_creates, **self.group.law_parameters}
        return lawentry.parameters_of(self.group.law, self.law, given, f"{self.group.name}.law.")

    @property
    def for_creates(self) -> dict[str, Any]:
        """The parameters that the law's file names for Creates."""
        return getattr(self.law, "CREATE", {})

    @cached_property
    def selections(self) -> list[list[selection.Chosen]]:
        """The steps that make each of the law's sets, with numbers in place."""
        sets = selection.parse_sets(self.group.selection, lawentry.sets_of(self.law), declared(self.law.Parameters))
        values = self.law_parameters._asdict()
        return [selection.resolved(steps, values) for steps in sets]

    @cached_property
    def pipeline(self) -> ModuleType:
        """The member detection's file."""
        return found.load(PIPELINES, self.group.pipeline, "pipeline")

    @property
    def pipeline_reads(self) -> frozenset[str]:
        """What the member detection reads of a robot's senses."""
        return frozenset(self.pipeline.READS)

    @cached_property
    def pipeline_parameters(self) -> Any:
        """The member detection's parameters."""
        prefix = f"{self.group.name}.pipeline."
        return filled(self.pipeline.Parameters, self.group.pipeline_parameters, prefix=prefix)

    @cached_property
    def body(self) -> Body:
        """The body of its robots."""
        name, files = self.given.body, self.given.body_files
        if files and bodies.digest(name) != files:
            raise InputError(f"the files of body {name!r} have changed since the run began; expected the same")
        return bodies.load(name)

    @cached_property
    def laser(self) -> hokuyo.Parameters:
        """The laser's parameters: the named setting with the group's own values in place."""
        own = below(self.group.setup, SENSORS)
        changed = self._below(SENSORS, hokuyo.Parameters)
        return hokuyo.SETTINGS[self.given.sensors]._replace(**{name: getattr(changed, name) for name in own})

    @cached_property
    def cameras(self) -> setting.Parameters:
        """The cameras' parameters."""
        cameras: setting.Parameters = self._below(CAMERAS, setting.Parameters)
        return cameras

    @cached_property
    def imperfections(self) -> imperfections.Parameters:
        """What is imperfect about its cameras: the named setting with the group's own values in place."""
        own = below(self.group.setup, IMPERFECTIONS)
        changed = self._below(IMPERFECTIONS, imperfections.Parameters)
        named = imperfections.SETTINGS[self.cameras.setting]
        return named._replace(**{name: getattr(changed, name) for name in own})

    @property
    def reads_images(self) -> bool:
        """Whether the member detection reads what cameras see."""
        return "images" in self.pipeline_reads

    @property
    def reads_echoes(self) -> bool:
        """Whether the member detection makes obstacles of what sonars hear, where the body has some."""
        return "echoes" in self.pipeline_reads

    @property
    def hears(self) -> bool:
        """Whether its robots' sonars are read: they have some, and its law or its avoidance asks for obstacles."""
        return self.reads_echoes and SONAR in self.body.mounts and "obstacles" in self.wanted.needs

    @property
    def reads_laser(self) -> bool:
        """Whether the member detection reads a laser."""
        return bool(self.pipeline_reads & LASER)

    @cached_property
    def association(self) -> association.Parameters:
        """The parameters of association."""
        return self._below(ASSOCIATION, association.Parameters)

    @cached_property
    def avoidance(self) -> avoidance.Parameters:
        """The parameters of the avoidance of obstacles that all laws share."""
        return self._below(AVOIDANCE, avoidance.Parameters)

    @cached_property
    def wanted(self) -> Wanted:
        """What its law needs; `information.check` refuses a group that cannot have it."""
        needs = lawentry.needs_of(self.law) | selection.needs(step for steps in self.selections for step in steps)
        if self.avoids:
            needs |= {"obstacles"}
        has = given_by(self.pipeline)
        if self.reads_echoes and SONAR in self.body.mounts:
            has |= {"obstacles"}
        missing = needs - has - OF_ITSELF
        inferable = missing & INFERRED if self.associates and "positions" in has else frozenset()
        of_each = needs - lawentry.may_lack_of(self.law)
        return Wanted(needs, of_each, missing, inferable, bool(needs & {"compass", "goal"}) or bool(inferable))

    @property
    def associates(self) -> bool:
        """Whether its robots may infer velocities and headings from two detections."""
        return self.given.association == TWO_SCANS

    @property
    def avoids(self) -> bool:
        """Whether obstacles are avoided, or made virtual members, in addition to what the law does about them."""
        return self.given.obstacles != AS_LAW

    def look_all_up(self) -> None:
        """Reads every property. Raises `InputError` for a name that does not exist or a number that does not fit."""
        names = (
            "given",
            "law_parameters",
            "selections",
            "pipeline_parameters",
            "body",
            "laser",
            "cameras",
            "imperfections",
            "association",
            "avoidance",
        )
        for name in names:
            getattr(self, name)
        obstacle_selection.parse(self.given.obstacle_selection)

    def _below(self, prefix: str, parameters: type) -> Any:
        return filled(parameters, below(self.group.setup, prefix), prefix=f"{self.group.name}.{prefix}")
