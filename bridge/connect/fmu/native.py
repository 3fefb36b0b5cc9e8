"""Object code of the twin's kernels for an FMU: plain C functions, without numba, Python or a runtime of either."""

import hashlib
from functools import cache
from typing import Any

import numpy as np
from llvmlite import binding

from twin.kernel import module_of
from twin.native_code import numbers_of

OPTIMISATION = 3


def object_code(name: str, kernel: Any, examples: tuple[Any, ...], triple: str, processor: str) -> bytes:
    """A kernel as the C function of a name: arrays become pointers, of the sizes of the examples; it returns 0."""
    _initialize()
    module = binding.parse_bitcode(module_of(kernel, *examples))
    (target,) = (function.name for function in module.functions if not function.is_declaration)
    machine = _machine(triple, processor)
    module.triple, module.data_layout = triple, str(machine.target_data)
    wrapper = binding.parse_assembly(_wrapper(name, target, examples))
    wrapper.triple, wrapper.data_layout = triple, str(machine.target_data)
    module.link_in(wrapper)
    for own in (*module.functions, *module.global_variables):
        if not own.is_declaration and own.name != name:
            own.linkage = "internal"
            own.name = f"{name}_{hashlib.sha256(own.name.encode()).hexdigest()[:8]}"  # numba's are 300 letters long
    module.verify()
    _tidy(module, machine)
    return machine.emit_object(module)


@cache
def _initialize() -> None:
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()


def _machine(triple: str, processor: str) -> binding.TargetMachine:
    target = binding.Target.from_triple(triple)
    return target.create_target_machine(cpu=processor, opt=OPTIMISATION, reloc="pic", codemodel="default")


def _tidy(module: binding.ModuleRef, machine: binding.TargetMachine) -> None:
    """Drop what nobody refers to. The kernel is optimised already."""
    options = binding.create_pipeline_tuning_options(speed_level=0)
    builder = binding.create_pass_builder(machine, options)
    passes = binding.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, builder)


def _wrapper(name: str, target: str, examples: tuple[Any, ...]) -> str:
    """LLVM's text of the C function: numba's code takes an array as seven numbers or more."""
    own, passed = [], ["ptr %result", "ptr %error"]
    for place, example in enumerate(examples):
        if not isinstance(example, np.ndarray):
            kind = "double" if isinstance(example, float) else "i64"
            own.append(f"{kind} %a{place}")
            passed.append(f"{kind} %a{place}")
            continue
        own.append(f"ptr %a{place}")
        _, _, size, width, _, *form = numbers_of(example)
        numbers = [f"i64 {number}" for number in form]
        passed += ["ptr null", "ptr null", f"i64 {size}", f"i64 {width}", f"ptr %a{place}", *numbers]
    kinds = ", ".join(argument.split()[0] for argument in passed)
    return f"""
declare i32 @{target}({kinds})
define i32 @{name}({", ".join(own)}) {{
  %result = alloca ptr
  %error = alloca ptr
  %code = call i32 @{target}({", ".join(passed)})
  ret i32 %code
}}
"""
