"""numba's side of the kernels: imported when something must be compiled, or is called from Python through numba."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding, ir
from numba.core import config, types
from numba.core.typing.templates import make_intrinsic_template, make_overload_template
from numba.np.arrayobj import make_array, populate_array

from twin.compiled_code import KernelCache
from twin.native_code import CALLER, NativeCode, machine

SLOT = ir.IntType(64)


def compiled_function(function: Callable[..., Any], folder: Path | None, options: dict[str, Any]) -> Any:
    """numba's function, which keeps its compiled code in a folder."""
    compiled: Any = numba.njit(**options)(function)
    if folder:
        config.CACHE_DIR = str(folder)  # pyright: ignore[reportAttributeAccessIssue]
        compiled._cache = KernelCache(function)
    return compiled


def chosen_when_compiled(name: Any, choose: Callable[..., Any], folder: Path | None, options: dict[str, Any]) -> Any:
    """numba's type of a function whose source is chosen, by the types of its arguments, when its caller is compiled.

    It is kept in a folder, too. The way in from Python, half of numba's work on a small function, is not made.
    """
    template: Any = make_overload_template(name, choose, options, False, "never")
    template._get_jit_decorator = lambda _: lambda **chosen: lambda f: compiled_function(f, folder, chosen)
    return types.Function(template)


def type_of_rows(name: Any) -> Any:
    """numba's type of `rows`."""
    return types.Function(make_intrinsic_template(name, _rows, "rows"))


def _rows(_: Any, flat: Any, count: Any, width: Any) -> Any:
    """A contiguous array as a view of rows of a width."""

    def code(context: Any, build: Any, signature: Any, arguments: Any) -> Any:
        source = make_array(flat)(context, build, arguments[0])
        view = make_array(signature.return_type)(context, build)
        shape = arguments[1:]
        strides = [build.mul(shape[1], source.itemsize), source.itemsize]
        populate_array(view, source.data, shape, strides, source.itemsize, source.meminfo, source.parent)
        return view._getvalue()

    return flat.copy(ndim=2)(flat, types.intp, types.intp), code


def native_code(function: Any, examples: tuple[Any, ...], **options: Any) -> tuple[NativeCode, bytes]:
    """Compile a function for arguments of the types of the examples. It returns None or a number.

    And its module of LLVM, as bitcode, of which code for other processors can be made.
    """
    bare: Any = options | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    dispatcher: Any = numba.njit(**bare)(function)
    dispatcher.compile(tuple(map(numba.typeof, examples)))
    (result,) = dispatcher.overloads.values()
    returned = result.signature.return_type
    if returned not in (types.none, types.float64):
        raise TypeError(f"{function.__name__} returns {returned}: an entry returns None or a number")
    library = result.library
    code = NativeCode(library._get_compiled_object(), _caller(result), _needed(library), returned is types.float64)
    return code, library._final_module.as_bitcode()


def _needed(library: Any) -> tuple[str, ...]:
    declared = [f.name for f in library._final_module.functions if f.is_declaration]
    return tuple(name for name in declared if not name.startswith("llvm."))


def _caller(result: Any) -> bytes:
    """Object code of a function that calls another with the numbers that stand in a row of slots."""
    kind = result.target_context.call_conv.get_function_type(result.fndesc.restype, result.fndesc.argtypes)
    module = ir.Module()
    module.triple = binding.get_process_triple()
    target = ir.Function(module, kind, result.fndesc.llvm_func_name)
    caller = ir.Function(module, ir.FunctionType(kind.return_type, [SLOT.as_pointer()]), CALLER)
    build = ir.IRBuilder(caller.append_basic_block())
    places = [build.gep(caller.args[0], [SLOT(number)]) for number in range(len(kind.args))]
    result_and_error = [build.bitcast(place, to) for place, to in zip(places[:2], kind.args[:2], strict=True)]
    loaded = [
        build.load(build.bitcast(place, to.as_pointer())) for place, to in zip(places[2:], kind.args[2:], strict=True)
    ]
    build.ret(build.call(target, result_and_error + loaded))
    return machine().emit_object(binding.parse_assembly(str(module)))
