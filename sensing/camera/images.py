"""The two images of a robot, taken together: the types, which stand beside the laser's."""

from __future__ import annotations

from sensing.types import Images, Picture

__all__ = ["Images", "Picture"]
