"""The one entry to numba: kernels are plain Python functions, compiled once and kept in a folder.

A kernel is loaded when it is first called from Python. Most are only called by other kernels, whose compiled code
holds them: these are compiled for themselves only where a test calls them.

A kernel has one explicit signature, checks its indices, and raises what plain Python would raise. With
`NUMBA_DISABLE_JIT=1` the same source runs as plain Python. Nothing here relaxes floating-point arithmetic, so the bits
of a result do not depend on the processor.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Flags, compile_extra
from numba.core.compiler_lock import global_compiler_lock
from numba.core.runtime.nrt import rtsys
from numba.core.sigutils import normalize_signature
from numba.core.typing.templates import make_concrete_template

from assur.planner.errors import FaultError
from assur.planner.kernel_cache import WHOLE, digest, folder

F = TypeVar("F", bound=Callable[..., object])

_numba: Any = partial(
    numba.njit, error_model="python", boundscheck=True, no_cpython_wrapper=True, no_cfunc_wrapper=True
)
types: Any = numba.types
"""The types of signatures that hold named tuples; all others are written as text."""
KERNELS: dict[str, Any] = {}
"""Every kernel that was defined in this process, by module and name."""
_FIRST_USES: dict[str, _FirstUse] = {}


class _Place(CompileResultCacheImpl):
    """Tells numba where a kernel's compiled code is, and what of it is kept. Unlike numba's own, it accepts a folder
    that cannot be written. It keeps machine code only: to read the intermediate code takes three times as long."""

    def __init__(self, function: Callable[..., object]) -> None:
        code = function.__code__
        self._locator, self._py_file, self._lineno = self, code.co_filename, code.co_firstlineno
        name = function.__qualname__.replace("<", "").replace(">", "")
        tag = sys.implementation.cache_tag
        self._filename_base = f"{Path(code.co_filename).stem}.{name}-{code.co_firstlineno}.{tag}"

    def get_cache_path(self) -> str:
        """The folder, one a room: modules of two rooms may have the same name."""
        return str(folder() / Path(self._py_file).parent.name)

    def ensure_cache_path(self) -> None:
        """Makes the folder."""
        Path(self.get_cache_path()).mkdir(parents=True, exist_ok=True)

    def get_source_stamp(self) -> str:
        """What compiled code must carry to be good."""
        return digest()

    def reduce(self, data: Any) -> Any:
        """What is kept of a kernel that was compiled: an empty module in place of its intermediate code, and no
        environment of a function of numba's that has no constants. Nothing reads these, and to load them imports half
        of SciPy."""
        (name, kind, (machine, _)), *described, environments = super().reduce(data)
        used = [each for each in environments if each.consts or not each.globals["__name__"].startswith("numba.")]
        return (name, kind, (machine, data.codegen._llvm_module.as_bitcode())), *described, used

    def rebuild(self, target_context: Any, reduced_data: Any) -> Any:
        """The kernel again. numba would read the name of the function that Python calls in the intermediate code."""
        target_context.codegen()._engine._defined_symbols.add(reduced_data[1].llvm_cpython_wrapper_name)
        return super().rebuild(target_context, reduced_data)


class _Cache(FunctionCache):
    _impl_class = _Place

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled code, if it is in the folder. numba's own loads all that it can compile first, 0.2 s; compiling
        does that, too."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class _Part(JITCodeLibrary):
    """Code of a kernel as a part of those that call it: only in these it is linked, optimised and made machine code."""

    def finalize(self) -> None:
        self._finalized = True


class _FirstUse:
    """Loads the compiled code of a kernel, or compiles it, when it is first called; and compiles it as a part of a
    kernel that calls it. numba calls three methods of a dispatcher for that; they are replaced here."""

    def __init__(self, made: Any, name: str, signature: Any, entry: bool) -> None:
        self._made, self._name, self._signature, self.entry = made, name, signature, entry
        self.compiled = False
        """Whether it was compiled in this process, and not loaded."""
        made._compile_for_args, made.get_call_template, made.get_overload = self.entry_point, self.template, self.part

    def load(self) -> None:
        """Raises `FaultError` where it is not compiled and the folder cannot be written."""
        made = self._made
        with global_compiler_lock:  # the one lock of the compiler: with two, two threads could wait for each other
            if not made._can_compile:
                return
            try:
                code = made._cache.load_overload(self._signature, made.targetctx)
                if code is None:
                    code, self.compiled = self._code(), True
                    made._cache.save_overload(self._signature, code)
            except OSError as error:
                raise FaultError(
                    f"kernel {self._name} is not compiled, and {folder()} cannot be written ({error.strerror}): "
                    "run `assur kernels` where it can"
                ) from error
            made.add_overload(code)
            made.disable_compile()

    def entry_point(self, *arguments: object) -> Any:
        """The compiled code, which numba calls with these arguments. Raises `TypeError` as numba does later."""
        self.load()
        (code,) = self._made.overloads.values()
        given = [self._made.typeof_pyval(argument) for argument in arguments]
        wanted = code.signature.args
        convertible = self._made.typingctx.can_convert
        if len(given) != len(wanted) or any(convertible(a, b) is None for a, b in zip(given, wanted, strict=True)):
            raise TypeError(f"No matching definition for argument type(s) {', '.join(map(str, given))}")
        return code.entry_point

    @cached_property
    def _part(self) -> Any:
        made = self._made
        flags: Any = Flags()
        made._compiler.targetdescr.options.parse_as_flags(flags, made.targetoptions)
        flags.no_compile = True
        library = _Part(made.targetctx.codegen(), self._name)
        of_signature = *normalize_signature(self._signature), flags, {}, library
        part = compile_extra(made.typingctx, made.targetctx, made.py_func, *of_signature)
        # what calls it links its parts, too
        made.targetctx.insert_user_function(library, part.fndesc, [library, *library._linking_libraries])
        return part

    def _code(self) -> Any:
        """The part with its own parts, and a function that Python calls, as machine code."""
        part = self._part
        context, described, environment = part.target_context, part.fndesc, part.environment
        library = context.codegen().create_library(self._name)
        library.enable_object_caching()
        for each in (part.library, *part.library._linking_libraries):
            library.add_linking_library(each)
        context.create_cpython_wrapper(library, described, environment, part.call_helper, release_gil=True)
        entry_point = context.get_executable(library, described, environment)
        code = part._replace(library=library, entry_point=entry_point)
        for each in code._find_referenced_environments():
            code.codegen.set_env(each.env_name, each)
        return code

    def template(self, args: Any, kws: Any) -> Any:
        signature, args = self._made._compiler.fold_argument_types(args, kws)
        return make_concrete_template(self._name, self._name, [self._part.signature]), signature, args, {}

    def part(self, _: object) -> Any:
        return self._part.library


def kernel(signature: Any, *, allocates: bool = False, inline: bool = False, entry: bool = False) -> Callable[[F], F]:
    """Compiles a function for one signature, such as ``"float64(float64[:, ::1], int64)"`` or the same made of `types`,
    or loads what was compiled, when it is first called.

    `allocates`: whether it makes arrays of its own. One that does not is compiled without numba's memory management,
    which otherwise counts the users of every table at every call: 5 to 6 times the time of a short kernel. One that
    makes an array without saying so raises `numba.core.errors.NumbaError`.

    `inline`: whether its code becomes part of each kernel that calls it. A table is handed over as nine numbers, so a
    call with all tables of a claim, and of what is computed of it, copies 4 kB, which takes 100 ns.

    `entry`: whether Python calls it although kernels do, too. `load_defined` compiles these and those that no kernel
    calls.

    An index beyond the end raises `IndexError` (a negative one counts from the end, as in Python: test it yourself); a
    division by zero raises `ZeroDivisionError`; an argument of another type, a read-only array among them, raises
    `TypeError`. Raises `FaultError` for a kernel that is not in the folder where the folder cannot be written:
    compiling it anew in every process would take seconds each time.
    """

    def define(function: F) -> F:
        name = f"{function.__module__}.{function.__name__}"
        made: Any = _numba(_nrt=allocates, forceinline=inline)(function)
        KERNELS[name] = made
        if made is not function:
            made._cache = _Cache(function)
            _FIRST_USES[name] = _FirstUse(made, name, signature, entry)
        compiled: F = made
        return compiled

    return define


def entries() -> list[str]:
    """Names of the kernels that Python calls, of those that were defined in this process."""
    made = {name: kernel for name, kernel in KERNELS.items() if name in _FIRST_USES}
    bodies = [kernel.py_func for kernel in made.values()]
    called = {id(body.__globals__.get(word)) for body in bodies for word in body.__code__.co_names}
    return [name for name, kernel in made.items() if _FIRST_USES[name].entry or id(kernel) not in called]


def load_defined(within: str = "") -> None:
    """Loads every kernel that Python calls, in modules whose names begin so, or compiles it.

    Raises as `kernel` says.
    """
    for name in entries():
        if name.startswith(within):
            _FIRST_USES[name].load()


def compiled_now() -> list[str]:
    """Names of the kernels that this process had to compile, because the folder did not have them."""
    return [name for name, use in _FIRST_USES.items() if use.compiled]


def mark_whole() -> None:
    """Says in the folder that every kernel that Python calls is there; the caller has loaded them all."""
    if KERNELS and not (folder() / WHOLE).is_file():
        (folder() / WHOLE).write_text("\n".join(entries()) + "\n", encoding="utf-8")
