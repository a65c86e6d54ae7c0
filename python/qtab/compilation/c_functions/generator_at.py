"""Numba's generator around a ``bitgen_t`` that is given by its address: no Python object, no reference count."""

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
"""``generator_at(address)``, for compiled code: the generator whose ``bitgen_t`` is at the address."""
