"""A scheduler that asks for certificates: work reaches it with them; without, one line says so."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.manifest import made

pytest.importorskip("distributed")
OPENSSL = shutil.which("openssl")
pytestmark = pytest.mark.skipif(OPENSSL is None, reason="certificates are made by openssl")
MAKE = "req -x509 -newkey rsa:2048 -nodes -days 1 -subj /CN=me -keyout key.pem -out cert.pem"
ROLES = ("client", "scheduler", "worker")


def _twice(task: int) -> int:
    return 2 * task


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """One that signs itself, and its key: as `docs/cluster.md` makes them."""
    room = tmp_path_factory.mktemp("tls")
    subprocess.run(
        [str(OPENSSL), *MAKE.split()],
        cwd=room,
        check=True,
        capture_output=True,
    )
    return room / "cert.pem", room / "key.pem"


def _settings(certificate: tuple[Path, Path]) -> dict[str, Any]:
    """Of `distributed`, as its configuration has them."""
    cert, key = map(str, certificate)
    found: dict[str, Any] = {"ca-file": cert}
    for role in ROLES:
        found |= {f"{role}.cert": cert, f"{role}.key": key}
    return {
        **{f"distributed.comm.tls.{name}": value for name, value in found.items()},
        "distributed.comm.require-encryption": True,
    }


def _environment(certificate: tuple[Path, Path]) -> dict[str, str]:
    """The same, for processes."""
    cert, key = map(str, certificate)
    found = {"DASK_DISTRIBUTED__COMM__TLS__CA_FILE": cert}
    found["DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION"] = "true"
    for role in ROLES:
        found[f"DASK_DISTRIBUTED__COMM__TLS__{role.upper()}__CERT"] = cert
        found[f"DASK_DISTRIBUTED__COMM__TLS__{role.upper()}__KEY"] = key
    return {**os.environ, **found}


@pytest.fixture(scope="module")
def scheduler(certificate: tuple[Path, Path]) -> Iterator[str]:
    """The address of one that speaks TLS alone, with a worker."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tls://127.0.0.1:{port}"
    commands = [
        f"dask_scheduler --host 127.0.0.1 --port {port} --protocol tls --no-dashboard",
        f"dask_worker {address} --nthreads 1 --no-nanny --no-dashboard",
    ]
    processes = [
        subprocess.Popen(
            [sys.executable, "-m", *f"distributed.cli.{words}".split()],
            env=_environment(certificate),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for words in commands
    ]
    try:
        yield address
    finally:
        for process in processes:
            process.kill()
            process.wait()


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine takes long to start a scheduler."""
    monkeypatch.setattr("realitygap.studies.plumbing.execution.CONNECT_SECONDS", 300.0)


def test_work_reaches_workers_through_tls_with_the_certificates_of_the_configuration(
    scheduler: str, certificate: tuple[Path, Path], patient: None
) -> None:
    import dask

    with dask.config.set(_settings(certificate)):
        done = list(made(_twice, [1, 2, 3], Workers(1, scheduler)))
    assert sorted(one.value or 0 for one in done) == [2, 4, 6]


@pytest.mark.parametrize(
    ("address", "settings", "said"),
    [
        ("tls://127.0.0.1:1", {}, "certificates in Dask's configuration"),
        (
            "tls://127.0.0.1:1",
            {f"distributed.comm.tls.{k}": "nowhere.pem" for k in ("ca-file", "client.cert")},
            "certificates that can be read",
        ),
        (
            "tcp://127.0.0.1:1",
            {"distributed.comm.require-encryption": True},
            "an address tls://",
        ),
    ],
)
def test_an_address_that_does_not_fit_the_certificates_is_one_clear_line(
    address: str, settings: dict[str, Any], said: str
) -> None:
    import dask

    with (
        dask.config.set(settings),
        pytest.raises(InputError, match=f"--scheduler: got {address}, expected {said}") as refused,
    ):
        list(made(_twice, [1], Workers(1, address)))
    assert "\n" not in str(refused.value)
