"""A law's entry handed to compiled code by its address.

To be handed a compiled function, compiled code asks Python for its signature and its addresses at every call: some 50
microseconds. A loop that a body's physics interrupts at each step takes the address instead.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core import cgutils, sigutils, types
from numba.experimental.function_type import _get_jit_address
from numba.extending import intrinsic

from flocking.lawentry import ENTRY_SIGNATURE

_SIGNATURE = sigutils._parse_signature_string(ENTRY_SIGNATURE)
_ENTRY = types.FunctionType(_SIGNATURE)


def address_of(entry: Callable[..., None]) -> int:
    """Where a law's compiled entry begins. The law must live as long as the address is used."""
    found: int = _get_jit_address(entry, _SIGNATURE)
    return found


@intrinsic
def at_address(_typing: Any, address: Any) -> Any:
    """The entry at such an address, to be called by compiled code alone."""

    def made(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        function = cgutils.create_struct_proxy(_ENTRY)(context, builder)
        nothing = cgutils.get_null_value(function.c_addr.type)
        function.c_addr = function.py_addr = nothing
        function.jit_addr = builder.inttoptr(arguments[0], nothing.type)
        return function._getvalue()

    return _ENTRY(types.int64), made
