"""Two numbers at once. For compiled code: a processor's divider takes as long for one as for two."""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.core.types.containers import UniTuple
from numba.extending import lower_builtin, type_callable


def over(x: float, y: float, divisor: float) -> tuple[float, float]:
    """x and y, each divided by the same number: (x / divisor, y / divisor), to the last bit."""
    return x / divisor, y / divisor


@type_callable(over)
def _type_of_over(_: Any) -> Any:
    def typed(x: Any, y: Any, divisor: Any) -> Any:
        return UniTuple(types.float64, 2) if {x, y, divisor} == {types.float64} else None

    return typed


@lower_builtin(over, types.float64, types.float64, types.float64)
def _over(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    x, y, divisor = arguments
    quotients = builder.fdiv(_lanes(builder, x, y), _lanes(builder, divisor, divisor))
    return context.make_tuple(
        builder, signature.return_type, [builder.extract_element(quotients, _place(k)) for k in range(2)]
    )


def _lanes(builder: Any, x: Any, y: Any) -> Any:
    empty = ir.Constant(ir.VectorType(ir.DoubleType(), 2), ir.Undefined)
    return builder.insert_element(builder.insert_element(empty, x, _place(0)), y, _place(1))


def _place(k: int) -> Any:
    return ir.Constant(ir.IntType(32), k)
