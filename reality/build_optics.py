"""Builds the geometry of reality's senses as the extension `reality._optics` (cffi, API mode)."""

import os
from pathlib import Path

from cffi import FFI

HEADER = Path(__file__).parent / "optics" / "optics.h"
COMPILE = ["-std=c11", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
DEVELOPMENT = ["-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror"]

ffibuilder = FFI()
ffibuilder.cdef(
    HEADER.read_text(encoding="utf-8").split("/* binding begin */")[1].split("/* binding end */")[0]
)
ffibuilder.set_source(
    "realitygap.reality._optics",
    '#include "optics.h"',
    sources=["reality/optics/optics.c"],
    include_dirs=["reality/optics"],
    depends=["reality/optics/optics.h"],
    extra_compile_args=COMPILE + (DEVELOPMENT if os.environ.get("REALITYGAP_DEVELOPMENT") else []),
    libraries=["m"],
)
