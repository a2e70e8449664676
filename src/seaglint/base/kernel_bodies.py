"""Bodies of compiled functions for their callers: code to be linked in, without separate machine code.

Numba compiles each function as a whole program: optimised, with machine code, a wrapper for Python and one for C. A function that only
compiled functions call needs none of these; they take a third of the time of compilation.

Names below that begin with ``_`` are private to Numba: its version is bounded for them in ``pyproject.toml``.
"""

# Numba has types for its public names alone.
# mypy: disable-error-code="no-untyped-call, call-arg"

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from numba.core import caching
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult


class _NoEnvironment:
    """Code generator that sets no environment: the body has no address."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, env: Any) -> None:
        """Do nothing: a body has no environment."""


class LinkedBody(JITCodeLibrary):
    """Code of a function for its callers to link in and optimise, without machine code."""

    @property
    def codegen(self) -> Any:
        """Code generator of the library."""
        return _NoEnvironment(self._codegen)

    def _optimize_final_module(self) -> None:
        """Do nothing: callers inline the body and optimise the result."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: a body has no address."""
        return 0

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """Return the code as LLVM's bitcode."""
        return self.name, "bitcode", self._get_module_for_linking().as_bitcode()

    @classmethod
    def loaded(cls, codegen: Any, name: str, bitcode: bytes) -> LinkedBody:
        """Return a body from its cached bitcode."""
        body = cls(codegen, name)
        body._final_module = llvm.parse_bitcode(bitcode)
        body._finalized = True
        return body


class BodyCompiler(Compiler):
    """Numba's compiler into a ``LinkedBody``."""

    def __init__(self, typing: Any, target: Any, library: Any, *others: Any) -> None:
        super().__init__(typing, target, LinkedBody(target.codegen(), "body") if library is None else library, *others)


def _rebuild(target: Any, payload: Any) -> Any:
    """Return the compiled form of a cached body."""
    (name, _, bitcode), fndesc, env, signature, objectmode, lifted, annotation, reload_init, _ = payload
    library = LinkedBody.loaded(target.codegen(), name, bitcode)
    return CompileResult(
        target_context=target,
        typing_context=target.typing_context,
        library=library,
        environment=env,
        entry_point=target.get_executable(library, fndesc, env),
        fndesc=fndesc,
        type_annotation=annotation,
        signature=signature,
        objectmode=objectmode,
        lifted=lifted,
        typing_error=None,
        call_helper=None,
        metadata=None,
        reload_init=reload_init,
        referenced_envs=[],
    )


class _Place(caching._CacheLocator):
    """Location of the cache of a function: a folder with a name that identifies all sources."""

    def __init__(self, file: str, folder: Path) -> None:
        self._py_file, self._folder = file, folder

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return self._folder.name

    def get_disambiguator(self) -> None:
        return None

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)


class KernelCache(caching.FunctionCache):
    """Numba's cache of one function, in files named by module and function, without line numbers, which change with prose above it."""

    def __init__(self, function: Callable[..., Any], folder: Path, form: str) -> None:
        place = _Place(function.__code__.co_filename, folder)
        stem = file_stem(function.__module__, function.__qualname__, form)
        self._name, self._py_func = repr(function), function
        self._impl = self._impl_class.__new__(self._impl_class)
        self._impl._lineno, self._impl._locator, self._impl._filename_base = 0, place, stem
        if form:
            self._impl.rebuild = _rebuild
        self._cache_path = place.get_cache_path()
        self._cache_file = caching.IndexDataCacheFile(self._cache_path, stem, place.get_source_stamp())
        self.enable()

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Return the key of a compiled form: types and processor.

        Numba adds the function's bytecode, which contains its docstring; here the folder's name identifies the sources.
        """
        return sig, codegen.magic_tuple()


def file_stem(module: str, name: str, form: str = "") -> str:
    """Return the first part of the names of a function's files."""
    plain = name.translate({ord(sign): None for sign in "<>"})
    return f"{module.removeprefix('seaglint.')}.{plain}{form}.{sys.implementation.cache_tag}"
