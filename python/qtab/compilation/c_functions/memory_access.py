"""Values with a layout in compiled code: their types, and how they are read from and written to memory."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.errors import TypingError
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array
from numba.np.numpy_support import as_dtype, from_dtype

from qtab.compilation.layouts.value_layout import Array, Layout, Number, Tuple, dtype_of, offsets


def type_of(layout: Layout) -> Any:
    """Returns the type of a value that is read from memory. Arrays are read-only: they stay in place."""
    if isinstance(layout, Number):
        return from_dtype(layout.dtype)
    if isinstance(layout, Array):
        return types.Array(from_dtype(layout.dtype), len(layout.shape), "C", readonly=True)
    return types.BaseTuple.from_types([type_of(item) for item in layout.items], layout.cls)


def layout_from(of: Any, example: Any, name: str = "the state") -> Layout:
    """Returns the layout of the values of a type in compiled code.

    Args:
        of: The type.
        example: A value in Python, from which the shapes of arrays are taken.
        name: The name of the value in messages.

    Raises:
        TypeError: if values of the type cannot be stored; the message gives the reason.
    """
    of = types.unliteral(of)
    if isinstance(of, types.Boolean):
        return Number(np.dtype(np.bool_))
    if isinstance(of, types.Integer | types.Float):
        return Number(as_dtype(of))
    if isinstance(of, types.Array) and isinstance(example, np.ndarray) and example.ndim == of.ndim:
        return Array(as_dtype(of.dtype), example.shape)
    if isinstance(of, types.BaseTuple) and isinstance(example, tuple) and len(of) == len(example):
        items = [
            layout_from(item, part, f"{name}[{index}]")
            for index, (item, part) in enumerate(zip(of, example, strict=True))
        ]
        return Tuple(tuple(items), getattr(of, "instance_class", None))
    raise TypeError(f"{name} is {_in_words(of)} in compiled code, and {type(example).__name__} in Python")


def united(one: Layout, other: Layout, name: str = "the state") -> Layout:
    """Returns the layout that holds the values of two layouts.

    Raises:
        TypeError: if there is none; the message gives the reason.
    """
    if isinstance(one, Tuple) and isinstance(other, Tuple) and len(one.items) == len(other.items):
        pairs = enumerate(zip(one.items, other.items, strict=True))
        return Tuple(tuple(united(*pair, f"{name}[{index}]") for index, pair in pairs), one.cls)
    if isinstance(one, Number) and isinstance(other, Number):
        return Number(np.result_type(one.dtype, other.dtype))
    if one == other:
        return one
    raise TypeError(f"{name} is {_layout_in_words(one)} at first, and {_layout_in_words(other)} later")


def reader(layout: Layout) -> Any:
    """Returns a function of an address for compiled code, which reads the value there."""

    def read(_typing: Any, address: Any) -> Any:
        def codegen(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            return load(context, builder, layout, builder.inttoptr(arguments[0], cgutils.voidptr_t))

        return type_of(layout)(types.uintp), codegen

    return intrinsic(read)


def writer(layout: Layout) -> Any:
    """Returns a function of an address and a value for compiled code, which writes the value there.

    It raises an error if an array has another shape than in the layout.
    """

    def write(_typing: Any, address: Any, value: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            pointer = builder.inttoptr(arguments[0], cgutils.voidptr_t)
            _store(context, builder, layout, signature.args[1], arguments[1], pointer)
            return context.get_dummy_value()

        return types.void(types.uintp, value), codegen

    return intrinsic(write)


def load(context: Any, builder: Any, layout: Layout, pointer: Any) -> Any:
    """Emits the instructions that read a value, and returns it."""
    of = type_of(layout)
    if isinstance(layout, Number):
        typed = builder.bitcast(pointer, context.get_data_type(of).as_pointer())
        return context.unpack_value(builder, of, typed)
    if isinstance(layout, Array):
        return _array(context, builder, of, layout, pointer)
    items = [
        load(context, builder, item, _moved(builder, pointer, offset))
        for item, offset in zip(layout.items, offsets(layout), strict=True)
    ]
    return context.make_tuple(builder, of, items)


def _store(context: Any, builder: Any, layout: Layout, of: Any, value: Any, pointer: Any) -> None:
    if isinstance(layout, Number):
        target = from_dtype(layout.dtype)
        typed = builder.bitcast(pointer, context.get_data_type(target).as_pointer())
        context.pack_value(builder, target, context.cast(builder, value, of, target), typed)
    elif isinstance(layout, Array):
        if not isinstance(of, types.Array) or of.ndim != len(layout.shape):
            raise TypingError(f"an array with {len(layout.shape)} axes is needed, got {of}")
        if as_dtype(of.dtype) != layout.dtype:
            raise TypingError(f"an array of {layout.dtype} is needed, got {of}")
        target = types.Array(from_dtype(layout.dtype), len(layout.shape), "C")
        array = _array(context, builder, target, layout, pointer)
        signature = types.void(target, of)
        if of.layout != "C":
            context.compile_internal(builder, _copy_array, signature, [array, value])
            return
        context.compile_internal(builder, _check_shape, signature, [array, value])
        source = builder.bitcast(context.make_array(of)(context, builder, value).data, cgutils.voidptr_t)
        size = ir.Constant(context.get_value_type(types.intp), dtype_of(layout).itemsize)
        cgutils.raw_memcpy(builder, pointer, source, size, 1)
    else:
        if not isinstance(of, types.BaseTuple) or len(of) != len(layout.items):
            raise TypingError(f"a tuple of {len(layout.items)} items is needed, got {of}")
        for index, (item, offset) in enumerate(zip(layout.items, offsets(layout), strict=True)):
            part = builder.extract_value(value, index)
            _store(context, builder, item, of.types[index], part, _moved(builder, pointer, offset))


def _check_shape(target: Any, source: Any) -> None:
    if source.shape != target.shape:
        raise ValueError("an array of the state has another shape than at first")


def _copy_array(target: Any, source: Any) -> None:
    if source.shape != target.shape:
        raise ValueError("an array of the state has another shape than at first")
    target[...] = source


def _array(context: Any, builder: Any, of: Any, layout: Array, pointer: Any) -> Any:
    word = context.get_value_type(types.intp)
    array = context.make_array(of)(context, builder)
    sizes = [dtype_of(Array(layout.dtype, layout.shape[axis + 1 :])).itemsize for axis in range(len(layout.shape))]
    populate_array(
        array,
        data=builder.bitcast(pointer, array.data.type),
        shape=[ir.Constant(word, size) for size in layout.shape],
        strides=[ir.Constant(word, size) for size in sizes],
        itemsize=ir.Constant(word, layout.dtype.itemsize),
        meminfo=None,
    )
    return array._getvalue()


def _moved(builder: Any, pointer: Any, offset: int) -> Any:
    return builder.gep(pointer, [ir.Constant(ir.IntType(64), offset)])


def _in_words(of: Any) -> str:
    if isinstance(of, types.Optional):
        return f"{of.type} or None"
    return str(of)


def _layout_in_words(layout: Layout) -> str:
    if isinstance(layout, Number):
        return str(layout.dtype)
    if isinstance(layout, Array):
        return f"an array of {layout.dtype} and shape {layout.shape}"
    return f"a tuple of {len(layout.items)} items"
