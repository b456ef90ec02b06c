"""Parts of arrays without the checks of a slice: no number is negative or too large here. For compiled code."""

from __future__ import annotations

from typing import Any, TypeVar

from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import lower_builtin, type_callable

from flocking.types import Bools, Floats, Ints

Rows = TypeVar("Rows", Floats, Ints)


def first(array: Rows, count: int) -> Rows:
    """The first `count` rows of an array (N, …), which has as many at least."""
    return array[:count]


def folded(array: Bools, rows: int, columns: int) -> Bools:
    """The first numbers of an array (N,), which has as many at least, as (rows, columns)."""
    return array[: rows * columns].reshape(rows, columns)


def _contiguous(array: Any) -> bool:
    return isinstance(array, types.Array) and array.layout == "C"


@type_callable(first)
def _type_of_first(_: Any) -> Any:
    def typed(array: Any, count: Any) -> Any:
        return array if _contiguous(array) and isinstance(count, types.Integer) else None

    return typed


@type_callable(folded)
def _type_of_folded(_: Any) -> Any:
    def typed(array: Any, rows: Any, columns: Any) -> Any:
        whole = isinstance(rows, types.Integer) and isinstance(columns, types.Integer)
        return array.copy(ndim=2) if _contiguous(array) and array.ndim == 1 and whole else None

    return typed


@lower_builtin(first, types.Array, types.Integer)
def _first(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    of, count = signature.args
    array = context.make_array(of)(context, builder, arguments[0])
    shape = cgutils.unpack_tuple(builder, array.shape, of.ndim)
    return _view(
        context, builder, signature, array, [context.cast(builder, arguments[1], count, types.intp), *shape[1:]]
    )


@lower_builtin(folded, types.Array, types.Integer, types.Integer)
def _folded(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    of, *whole = signature.args
    array = context.make_array(of)(context, builder, arguments[0])
    shape = [context.cast(builder, value, kind, types.intp) for value, kind in zip(arguments[1:], whole, strict=True)]
    return _view(context, builder, signature, array, shape)


def _view(context: Any, builder: Any, signature: Any, array: Any, shape: list[Any]) -> Any:
    """The memory of `array`, from its beginning on, as an array of that shape."""
    made = context.make_array(signature.return_type)(context, builder)
    size = context.get_constant(types.intp, context.get_abi_sizeof(context.get_data_type(signature.return_type.dtype)))
    stride, count = size, context.get_constant(types.intp, 1)
    strides: list[Any] = []
    for length in reversed(shape):
        strides.insert(0, stride)
        stride, count = builder.mul(stride, length), builder.mul(count, length)
    made.data, made.meminfo, made.parent = array.data, array.meminfo, array.parent
    made.itemsize, made.nitems = size, count
    made.shape, made.strides = cgutils.pack_array(builder, shape), cgutils.pack_array(builder, strides)
    return impl_ret_borrowed(context, builder, signature.return_type, made._getvalue())
