"""The type of ``self`` in compiled code: a pointer to the parameters, with attributes and methods."""

from types import FunctionType
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.errors import TypingError
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, overload_method, register_model

from qtab.compilation.c_functions.dispatchers import CHECKED_OPTIONS
from qtab.compilation.c_functions.memory_access import load, type_of
from qtab.compilation.layouts.parameters import Parameters
from qtab.compilation.layouts.value_layout import offsets


class SelfType(types.Type):  # type: ignore[misc]
    """The type of the ``self`` of one environment. Methods belong to a class, so that each has a subclass."""

    def __init__(self, parameters: Parameters, methods: dict[str, Any]) -> None:
        self.parameters, self.methods = parameters, methods
        layout = parameters.layout
        self.places = dict(zip(parameters.values, zip(layout.items, offsets(layout), strict=True), strict=True))
        super().__init__(name=f"qtab.self({id(self)})")


def self_type(parameters: Parameters, methods: dict[str, FunctionType]) -> SelfType:
    """Returns the type of the ``self`` of an environment.

    Args:
        parameters: Its attributes.
        methods: Its methods by their names: functions with ``self`` as their first argument.
    """
    cls = type("SelfType", (SelfType,), {})
    register_model(cls)(models.OpaqueModel)
    for name, function in methods.items():
        overload_method(cls, name, jit_options=CHECKED_OPTIONS)(_with_signature_of(function))
    made: SelfType = cls(parameters, methods)
    return made


def _with_signature_of(function: FunctionType) -> FunctionType:
    """Returns a function of types with the parameters of a function, which returns the function itself."""
    code = function.__code__
    names = code.co_varnames[: code.co_argcount]
    scope: dict[str, Any] = {"function": function}
    exec(f"def method({', '.join(names)}):\n    return function\n", scope)  # noqa: S102
    scope["method"].__defaults__ = function.__defaults__
    made: FunctionType = scope["method"]
    return made


class SelfAttributes(AttributeTemplate):  # type: ignore[misc]
    """Gives the types of attributes."""

    key = SelfType

    def generic_resolve(self, of: SelfType, name: str) -> Any:
        """Returns the type of an attribute; None for a method."""
        if name in of.places:
            return type_of(of.places[name][0])
        if name in of.parameters.constants:
            value = of.parameters.constants[name]
            return types.none if value is None else types.unicode_type
        if name in of.methods:
            return None
        raise TypingError(of.parameters.refused.get(name, f"self.{name} is unknown before the first reset"))


def _read(context: Any, builder: Any, of: SelfType, value: Any, name: str) -> Any:
    if name in of.places:
        layout, offset = of.places[name]
        return load(context, builder, layout, builder.gep(value, [ir.Constant(ir.IntType(64), offset)]))
    constant = of.parameters.constants[name]
    if constant is None:
        return context.get_dummy_value()
    return context.get_constant_generic(builder, types.unicode_type, constant)


infer_getattr(SelfAttributes)
lower_getattr_generic(SelfType)(_read)


def self_at(of: SelfType) -> Any:
    """Returns a function of an address for compiled code: ``self`` with the parameters there."""

    def at(_typing: Any, address: Any) -> Any:
        def codegen(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(of))

        return of(types.uintp), codegen

    return intrinsic(at)
