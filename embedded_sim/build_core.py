"""Builds the C core as the extension `embedded_sim._core` (cffi, out-of-line API mode)."""

import os
from pathlib import Path

from cffi import FFI

HERE = Path(__file__).parent
CORE = HERE / "core"

# -ffp-contract=off: no fused multiply-adds, so that every machine rounds alike.
# -fno-math-errno -fno-trapping-math change no result; they let gcc inline sqrt and fmin.
# -O3: measured a tenth faster than -O2 one by one, the same in lanes.
# -Wno-psabi: nothing passes vectors by call, so that it does not matter how that would be done.
COMPILE = [
    "-std=c11",
    "-O3",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-Wno-psabi",
]
DEVELOPMENT = ["-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror"]


def declarations() -> str:
    """The part of the public header that the binding reads."""
    header = (CORE / "realitygap_core.h").read_text(encoding="utf-8")
    return header.split("/* binding begin */")[1].split("/* binding end */")[0]


ffibuilder = FFI()
ffibuilder.cdef(declarations())
ffibuilder.set_source(
    "realitygap.embedded_sim._core",
    '#include "realitygap_core.h"',
    sources=[f"embedded_sim/core/{path.name}" for path in sorted(CORE.glob("*.c"))],
    include_dirs=["embedded_sim/core"],
    depends=[f"embedded_sim/core/{path.name}" for path in sorted(CORE.glob("*.h"))],
    extra_compile_args=COMPILE + (DEVELOPMENT if os.environ.get("REALITYGAP_DEVELOPMENT") else []),
    libraries=["m"],
)
