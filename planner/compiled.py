"""The one entry to numba: kernels are plain Python functions, compiled once and kept in a folder.

A kernel is loaded when it is first called from Python: to load one takes 8 ms, and most are only called by other
kernels, whose compiled code holds them.

A kernel has one explicit signature, checks its indices, and raises what plain Python would raise. With
`NUMBA_DISABLE_JIT=1` the same source runs as plain Python. Nothing here relaxes floating-point arithmetic, so the bits
of a result do not depend on the processor.
"""

from __future__ import annotations

import ctypes
import gc
import inspect
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.compiler_lock import global_compiler_lock

from assur.planner.errors import FaultError
from assur.planner.kernel_cache import WHOLE, digest, folder

F = TypeVar("F", bound=Callable[..., object])

_numba: Any = partial(numba.njit, cache=True, nogil=True, error_model="python", boundscheck=True)
types: Any = numba.types
"""The types of signatures that hold named tuples; all others are written as text."""
KERNELS: dict[str, Any] = {}
"""Every kernel that was defined in this process, by module and name."""
_FIRST_USES: dict[str, _FirstUse] = {}


class KernelFolder:
    """Tells numba where a kernel's compiled code is. Unlike numba's own, it accepts a folder that cannot be written."""

    def __init__(self, function: Callable[..., object], path: str) -> None:
        self._line = function.__code__.co_firstlineno
        self._room = Path(path).parent.name

    @classmethod
    def from_function(cls, function: Callable[..., object], path: str) -> KernelFolder:
        """The place of a function that stands in the file `path`."""
        return cls(function, path)

    def get_cache_path(self) -> str:
        """The folder, one a room: modules of two rooms may have the same name."""
        return str(folder() / self._room)

    def ensure_cache_path(self) -> None:
        """Makes the folder."""
        Path(self.get_cache_path()).mkdir(parents=True, exist_ok=True)

    def get_source_stamp(self) -> str:
        """What compiled code must carry to be good."""
        return digest()

    def get_disambiguator(self) -> str:
        """Tells functions of one name apart."""
        return str(self._line)


class _FirstUse:
    """Loads the compiled code of a kernel, or compiles it, when it is first called or when a kernel that calls it is
    compiled. numba calls the two methods of a dispatcher that has no compiled code yet; they are replaced here."""

    def __init__(self, made: Any, name: str, signature: Any) -> None:
        self._made, self._name, self._signature = made, name, signature
        self._template = made.get_call_template
        made._compile_for_args, made.get_call_template = self.entry_point, self.template

    def load(self) -> None:
        """Raises `FaultError` where it is not compiled and the folder cannot be written."""
        with global_compiler_lock:  # the one lock of the compiler: with two, two threads could wait for each other
            if not self._made._can_compile:
                return
            try:
                self._made.compile(self._signature)
            except OSError as error:
                raise FaultError(
                    f"kernel {self._name} is not compiled, and {folder()} cannot be written ({error.strerror}): "
                    "run `assur kernels` where it can"
                ) from error
            self._made.disable_compile()

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

    def template(self, args: object, kws: object) -> Any:
        self.load()
        return self._template(args, kws)


def kernel(signature: Any, *, allocates: bool = False, inline: bool = False) -> Callable[[F], F]:
    """Compiles a function for one signature, such as ``"float64(float64[:, ::1], int64)"`` or the same made of `types`,
    or loads what was compiled, when it is first called.

    `allocates`: whether it makes arrays of its own. One that does not is compiled without numba's memory management,
    which otherwise counts the users of every table at every call: 5 to 6 times the time of a short kernel. One that
    makes an array without saying so raises `numba.core.errors.NumbaError`.

    `inline`: whether its code becomes part of each kernel that calls it. A table is handed over as nine numbers, so a
    call with all tables of a claim, and of what is computed of it, copies 4 kB, which takes 100 ns.

    An index beyond the end raises `IndexError` (a negative one counts from the end, as in Python: test it yourself); a
    division by zero raises `ZeroDivisionError`; an argument of another type, a read-only array among them, raises
    `TypeError`. Raises `FaultError` for a kernel that is not in the folder where the folder cannot be written:
    compiling it anew in every process would take seconds each time.
    """

    def define(function: F) -> F:
        name = f"{inspect.getmodule(function).__name__}.{function.__name__}"  # type: ignore[union-attr]
        settings: Any = numba.config
        before = settings.CACHE_LOCATOR_CLASSES
        settings.CACHE_LOCATOR_CLASSES = f"{__name__}.{KernelFolder.__name__}"
        try:
            made: Any = _numba(_nrt=allocates, forceinline=inline)(function)
        finally:
            settings.CACHE_LOCATOR_CLASSES = before
        KERNELS[name] = made
        if made is not function:
            _FIRST_USES[name] = _FirstUse(made, name, signature)
        compiled: F = made
        return compiled

    return define


def load_defined(within: str = "") -> None:
    """Loads every kernel that was defined in this process, in modules whose names begin so, or compiles it. Raises as
    `kernel` says."""
    for name in list(KERNELS):
        if name in _FIRST_USES and name.startswith(within):
            _FIRST_USES[name].load()


def compiled_now() -> list[str]:
    """Names of the kernels that this process had to compile, because the folder did not have them."""
    return [name for name, made in KERNELS.items() if getattr(made, "stats", None) and made.stats.cache_misses]


def mark_whole() -> None:
    """Says in the folder that every kernel is there; the caller has loaded them all."""
    if KERNELS and not (folder() / WHOLE).is_file():
        (folder() / WHOLE).write_text("\n".join(KERNELS) + "\n", encoding="utf-8")


def release_compiler() -> None:
    """Frees the intermediate code of all kernels, about a quarter of the memory of a process that has loaded them.

    No kernel can be compiled any more that calls one of these.
    """
    for made in KERNELS.values():
        for compiled in getattr(made, "overloads", {}).values():
            compiled.library._shared_module = None
            compiled.library._linking_libraries = []
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
