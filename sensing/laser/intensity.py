"""How much light a surface sends back to the laser.

Unit: what a white diffuse surface (albedo 1) returns head-on at 1 m. The fall of retroreflective sheeting with the
angle between source and detector (to a half at 0.33 degrees) is left out, since how far the two stand apart in this
laser was not found: the gain of a geom is what this laser sees of it.
"""

from __future__ import annotations

import math

from flocking.compilation import compiled

NEAREST_M = 0.02
"""P: nearest distance that the laser measures (data sheet); nearer surfaces return no more than at this one."""
FALL = math.log(2.0) / math.sin(math.radians(40.0)) ** 2
"""S: retroreflective sheeting loses about half of its brightness at 40 degrees of incidence."""


@compiled
def returned(diffuse: float, retro: float, cosine: float, distance_m: float) -> float:
    """Returned light of a beam that meets a surface at an angle of incidence with the given cosine.

    A diffuse surface follows the cosine (Lambert). Retroreflective sheeting is flat about the normal and falls
    with 2^(−sin²θ / sin² 40°): a half at 40 degrees, still a fifth where it is seen edge-on (D: the simplest smooth
    curve through the one number known). Both fall with the square of the distance: the whole footprint lies on
    the surface and the light comes back into a fixed aperture.
    """
    distance = max(distance_m, NEAREST_M)
    brightness = diffuse * cosine
    if retro > 0.0:
        brightness += retro * math.exp(-FALL * (1.0 - cosine * cosine))
    return brightness / (distance * distance)
