"""The two C extensions; everything else about the distribution is in pyproject.toml."""

from setuptools import setup

setup(
    cffi_modules=[
        "embedded_sim/build_core.py:ffibuilder",  # realitygap.embedded_sim._core
        "reality/build_optics.py:ffibuilder",  # realitygap.reality._optics
    ],
    # both keep to the stable C interface, so that one wheel serves every Python from 3.11 on
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
