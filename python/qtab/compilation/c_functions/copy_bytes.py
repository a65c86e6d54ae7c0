"""Copies of bytes between addresses, for compiled code."""

from typing import Any

from numba.core import cgutils, types
from numba.extending import intrinsic


def _copy(_typing: Any, target: Any, source: Any, size: Any) -> Any:
    def codegen(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        target_pointer, source_pointer = (builder.inttoptr(one, cgutils.voidptr_t) for one in arguments[:2])
        cgutils.raw_memcpy(builder, target_pointer, source_pointer, arguments[2], 1)
        return context.get_dummy_value()

    return types.void(types.uintp, types.uintp, types.intp), codegen


copy_bytes: Any = intrinsic(_copy)
"""``copy_bytes(target, source, size)``: copies bytes between two addresses that do not overlap."""


def _pointer(_typing: Any, address: Any) -> Any:
    def codegen(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.uintp), codegen


pointer: Any = intrinsic(_pointer)
"""``pointer(address)``: the address as the pointer that ``numba.carray`` takes."""
