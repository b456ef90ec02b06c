"""Herds whose members are told of one another's velocities, desired or actual, and look anew every so many steps whom
they see: any law, compiled, for point masses and for bodies with dynamics of their own.

Source: Hodgins and Brogan 1994, "Robot herds", sections 3 and 4. The point masses with actual velocities, looking at
every step, are the kinematic herd (`flocking.kinematic`), which the tests hold them against. Metres, seconds, radians;
world frame.
"""

from flocking.herding.herd import HerdMind, Mood, MovingHerd

__all__ = ["HerdMind", "Mood", "MovingHerd"]
