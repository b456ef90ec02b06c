"""Many draws out of two, for laws that need one for each neighbour, however many there are. Compiled.

Source: L'Ecuyer 1988, "Efficient and portable combined random number generators", Communications of the ACM 31: the sum
of two multiplicative generators, of period 2e18, whose products stay below 2^47.
"""

from __future__ import annotations

from flocking.compilation import compiled

MODULUS, MULTIPLIER = 2147483563, 40014
OTHER_MODULUS, OTHER_MULTIPLIER = 2147483399, 40692


@compiled
def seeded(u: float, v: float) -> tuple[int, int]:
    """The state from which draws follow from the uniform numbers u and v in [0, 1).

    It depends on how far u and v are from one half: 1 - u and 1 - v lead to the same draws, so that a law can mirror
    what it makes of them.
    """
    first = 1 + min(int(abs(2.0 * u - 1.0) * (MODULUS - 1)), MODULUS - 2)
    second = 1 + min(int(abs(2.0 * v - 1.0) * (OTHER_MODULUS - 1)), OTHER_MODULUS - 2)
    return first, second


@compiled
def drawn(first: int, second: int) -> tuple[int, int, float]:
    """The state after a draw, and a uniform number in (0, 1)."""
    first = first * MULTIPLIER % MODULUS
    second = second * OTHER_MULTIPLIER % OTHER_MODULUS
    combined = first - second
    if combined < 1:
        combined += MODULUS - 1
    return first, second, combined / MODULUS
