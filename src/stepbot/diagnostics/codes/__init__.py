"""The table of diagnostic codes, one module per range.

SB0xx files and environment, SB1xx sidecar syntax and schema, SB2xx STEP, SB3xx component paths, SB4xx kinematics,
SB5xx mass and inertia, SB6xx meshes, SB7xx format limitations, SB8xx verification in engines, SB9xx internal errors.
A code is never renumbered or reused.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from .severity import Severity

if TYPE_CHECKING:
    from .code import Code


class _Codes(Mapping[str, "Code"]):
    """All codes. Their texts, about 100 kB, are imported when one is looked up: a run without findings needs none."""

    def __getitem__(self, code: str) -> "Code":
        return self._codes[code]

    def __iter__(self) -> Iterator[str]:
        return iter(self._codes)

    def __len__(self) -> int:
        return len(self._codes)

    @cached_property
    def _codes(self) -> "dict[str, Code]":
        from . import (
            assembly,
            binding,
            environment,
            formats,
            internal,
            kinematics,
            mass,
            mechanism,
            meshes,
            packages,
            revisions,
            self_collision,
            sidecar,
            simulators,
            sources,
        )

        return {
            code.id: code
            for module in (
                environment,
                sidecar,
                assembly,
                binding,
                revisions,
                kinematics,
                mechanism,
                mass,
                meshes,
                self_collision,
                packages,
                formats,
                simulators,
                sources,
                internal,
            )
            for code in module.CODES
        }


CODES: Mapping[str, "Code"] = _Codes()

RETIRED = frozenset({"SB307"})
"""Codes of earlier versions, which are not reused."""

__all__ = ["CODES", "RETIRED", "Severity"]
