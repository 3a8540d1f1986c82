"""The two C extensions; everything else about the distribution is in pyproject.toml."""

from setuptools import setup

setup(
    cffi_modules=[
        "embedded_sim/build_core.py:ffibuilder",  # realitygap.embedded_sim._core
        "reality/build_optics.py:ffibuilder",  # realitygap.reality._optics
    ]
)
