"""The message between a robot's image process and its controller, for laws that are written in these two parts.

Source: Kirchner 2006, section 3.6.7: ω, the closure rate, |d| and β are sent; where no cone is seen, a distance that
cannot be says so. Here that is nan, as all that is missing; the number 111.1 stands on the wire alone. SI units, body
frame, angles counter-clockwise.

A law that has the two parts is `controlled(message(...), ...)`; `flocking/lawparts.py` has either of them alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Message(NamedTuple):
    """What the image process tells the controller at one update."""

    omega: float
    """The turn that flocking asks for: rad/s, or rad/s² for a law that takes it for an acceleration."""
    closure: float
    """m/s: how fast the distance to the nearest member grows; negative: it comes nearer."""
    distance: float
    """m, to the nearest member; nan: nobody is in view."""
    bearing: float
    """rad, of the nearest member."""


NOBODY = Message(0.0, 0.0, math.nan, 0.0)
"""Nobody is in view."""
