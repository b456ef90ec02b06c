"""The two parts of a law that has a message between them (`flocking.message`), each made callable alone.

Such a law's file has `message(own, members, sets, obstacles, parameters) -> Message`, what the image process tells, and
`controlled(told, dt, parameters, memory, u) -> Motion`, what the controller makes of it; its `law` is the second of the
first. Compiled like the law itself, with fixed signatures of plain arrays, they give the same bits as the law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

from flocking import lawentry, lawsource
from flocking.errors import InputError, StorageError
from flocking.parameters import declared

MESSAGE_SIZE = 4
IMAGE_SIGNATURE = (
    "void(f8[::1], f8[:, ::1], f8[::1], f8[::1], f8[:, ::1], i8[::1], b1[:, ::1], f8[:, ::1], f8[::1], f8[::1])"
)
"""As `lawentry.ENTRY_SIGNATURE` up to the parameters; then the message out (4,)."""
CONTROL_SIGNATURE = "void(f8[::1], f8, f8[::1], f8[::1], f8[::1], f8[::1])"
"""message (4,), dt, parameters (P,), memory (MEMORY,), u (DRAWS,), motion out (4,): kind, x, y, rule."""

_TEMPLATE = '''"""Generated from a law's file: its two parts."""
import importlib.util
import sys

import numba
from flocking.compiled_cache import compiled_now, kept_between_runs
from flocking.message import Message
from flocking.types import Members, Obstacles, Own

_spec = importlib.util.spec_from_file_location({module!r}, {path!r})
_module = sys.modules.get({module!r})
if _module is None:
    _module = importlib.util.module_from_spec(_spec)
    sys.modules[{module!r}] = _module
    _spec.loader.exec_module(_module)


def _callable(part):
    return part if hasattr(part, "py_func") else numba.njit(part, boundscheck={boundscheck})


message, controlled = _callable(_module.message), _callable(_module.controlled)
Parameters = _module.Parameters


@numba.njit(boundscheck={boundscheck})
def image(own, positions, bearings, headings, velocities, ids, sets, obstacles, parameters, told):
    found = message(
        Own(own[0:2], own[2], own[3], own[4:6], (own[6] > 0.5, own[7] > 0.5), own[8], int(own[9]), int(own[10])),
        Members(positions, bearings, headings, velocities, ids),
        sets,
        Obstacles(obstacles),
        Parameters({values}),
    )
    told[0] = found.omega
    told[1] = found.closure
    told[2] = found.distance
    told[3] = found.bearing


@numba.njit(boundscheck={boundscheck})
def control(told, dt, parameters, memory, u, motion):
    decided = controlled(Message(told[0], told[1], told[2], told[3]), dt, Parameters({values}), memory, u)
    motion[0] = int(decided.kind + 0)
    motion[1] = decided.x
    motion[2] = decided.y
    motion[3] = decided.rule


if {cached}:
    kept_between_runs(image)
    kept_between_runs(control)
compiled_now(image, {image_signature!r})
compiled_now(control, {control_signature!r})
'''


@dataclass(frozen=True)
class Parts:
    """A law's two parts, compiled."""

    image: Callable[..., None]
    """With `IMAGE_SIGNATURE`."""
    control: Callable[..., None]
    """With `CONTROL_SIGNATURE`."""


def has_parts(module: ModuleType) -> bool:
    """Whether a law's module has the two parts."""
    return all(callable(getattr(module, part, None)) for part in ("message", "controlled"))


def names() -> list[str]:
    """Of the laws that have the two parts."""
    return [name for name in lawsource.names() if has_parts(lawentry.module_of(name))]


def load(law: lawentry.Law) -> Parts:
    """The parts of a law. Raises `InputError` for one that has none, or whose parts do not compile."""
    if not has_parts(law.module):
        raise InputError(f"law {law.name!r} has no message; expected a law that has one: {', '.join(names())}")
    fields = declared(law.module.Parameters)
    values = ", ".join(f"{field.type.__name__}(parameters[{i}])" for i, field in enumerate(fields.values()))
    try:
        made = lawentry.generated(
            law.module,
            "parts",
            _TEMPLATE,
            values=values,
            boundscheck=lawentry.is_path(law.name),
            image_signature=IMAGE_SIGNATURE,
            control_signature=CONTROL_SIGNATURE,
        )
    except StorageError:
        raise
    except Exception as error:
        raise InputError(f"law {law.name!r}: its parts do not compile: {lawsource.first_line(error)}") from None
    return Parts(made.image, made.control)
