"""Two quotients at once are those of two divisions, to the last bit."""

from __future__ import annotations

import numpy as np

from flocking.compilation import compiled
from flocking.lanes import over
from flocking.types import Floats


@compiled
def _all(pairs: Floats, divisors: Floats, out: Floats) -> None:
    for k in range(len(pairs)):
        out[k, 0], out[k, 1] = over(pairs[k, 0], pairs[k, 1], divisors[k])


def test_compiled_quotients_are_those_of_two_divisions() -> None:
    rng = np.random.default_rng(5)
    pairs, divisors = rng.normal(size=(500, 2)) * 10.0 ** rng.integers(-200, 200, (500, 1)), rng.normal(size=500)
    divisors[:4], pairs[4] = (np.inf, -np.inf, 0.0, 5e-324), (0.0, -0.0)
    out = np.empty_like(pairs)
    _all(pairs, divisors, out)
    with np.errstate(all="ignore"):
        expected = pairs / divisors[:, None]
    assert out.tobytes() == expected.tobytes()
    assert over(3.0, -1.0, 7.0) == (3.0 / 7.0, -1.0 / 7.0)
