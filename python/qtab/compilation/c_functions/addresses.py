"""What compiled code does with the addresses that C functions receive: generators, pointers and copies of bytes."""

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

GENERATOR: Any = types.NumPyRandomGeneratorType("rng")
"""The type of ``numpy.random.Generator`` in compiled code."""


def _generator_at(_typing: Any, address: Any) -> Any:
    def codegen(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        word = context.get_value_type(types.uintp)
        pointer = builder.inttoptr(arguments[0], word.as_pointer())
        state, *functions = (builder.load(builder.gep(pointer, [ir.Constant(ir.IntType(32), i)])) for i in range(4))
        bits = cgutils.create_struct_proxy(types.NumPyRandomBitGeneratorType("bit_generator"))(context, builder)
        bits.parent = cgutils.get_null_value(context.get_value_type(types.pyobject))
        bits.bit_generator, bits.state_address, bits.state = arguments[0], state, state
        bits.fnptr_next_uint64, bits.fnptr_next_uint32, bits.fnptr_next_double = functions
        generator = cgutils.create_struct_proxy(GENERATOR)(context, builder)
        generator.bit_generator = bits._getvalue()
        generator.meminfo = cgutils.get_null_value(generator.meminfo.type)
        generator.parent = cgutils.get_null_value(context.get_value_type(types.pyobject))
        return generator._getvalue()

    return GENERATOR(types.uintp), codegen


generator_at: Any = intrinsic(_generator_at)
"""``generator_at(address)``: the generator whose ``bitgen_t`` is there; no Python object, no reference count."""


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
