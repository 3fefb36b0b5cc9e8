"""Compiled functions on disk: one sealed file for each function and signature, written in one piece.

numba's own cache keeps an index beside its data: an index that a power cut has emptied ends every later start, and two
processes that compile at one time can mix their entries up. A file here is sealed; one that is damaged is compiled
anew. What cannot be written stays in memory.
"""

import os
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar

from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.serialize import dumps

from twin.sealed_files import Files


class Locator(UserProvidedCacheLocator):
    """The folder that `cache_directory` has chosen, which is not tried again for each function."""

    def ensure_cache_path(self) -> None:
        """Make the folder of one module."""
        with suppress(OSError):
            os.makedirs(self.get_cache_path(), exist_ok=True)


class Result(CompileResultCacheImpl):
    """What is kept of a compilation, and where."""

    _locator_classes: ClassVar = [Locator]


class KernelCache(FunctionCache):
    """The cache of one function."""

    _impl_class = Result

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        impl = self._impl
        folder, stamp = Path(impl.locator.get_cache_path()), impl.locator.get_source_stamp()
        self._cache_file = Files(folder, impl.filename_base, stamp, dumps)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it if that can be; it is in memory anyway."""
        with suppress(OSError):
            super().save_overload(sig, data)
