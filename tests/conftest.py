"""What every test may use: the folder of shared models and cases, and seeded random numbers."""

from __future__ import annotations

import ipaddress
import os
import socket
import tomllib
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parents[1]

settings.register_profile("vincula", derandomize=True, deadline=None, database=None)
settings.load_profile("vincula")


@pytest.fixture(scope="session")
def root() -> Path:
    """The checkout."""
    return ROOT


@pytest.fixture(scope="session")
def shared() -> Path:
    """Folder with reference numbers, real robots and independent results; skips where it is absent."""
    folder = Path(os.environ.get("VINCULA_SHARED", ROOT.parent / "shared"))
    if not folder.is_dir():
        pytest.skip("the shared folder is not here (set VINCULA_SHARED)")
    return folder


@pytest.fixture(scope="session")
def models(shared: Path) -> Path:
    """Folder of real robot files."""
    return shared / "models"


@pytest.fixture(scope="session")
def cases(shared: Path) -> Path:
    """Folder of independent reference results for those robots."""
    return shared / "cases"


@pytest.fixture(scope="session")
def paper(shared: Path) -> dict[str, Any]:
    """The numbers of the paper's two case studies, printed and recomputed."""
    return tomllib.loads((shared / "reference" / "paper.toml").read_text(encoding="utf-8"))


@pytest.fixture
def rng(request: pytest.FixtureRequest) -> np.random.Generator:
    """Random numbers that depend on the name of the test alone."""
    return np.random.default_rng(zlib.crc32(request.node.nodeid.encode()))


@pytest.fixture(scope="session", autouse=True)
def no_network() -> Iterator[None]:
    """Connections to anything but this machine are an error."""
    connect = socket.socket.connect

    def local_only(self: socket.socket, address: Any) -> None:
        if self.family in (socket.AF_INET, socket.AF_INET6) and not _is_loopback(str(address[0])):
            raise ConnectionRefusedError(f"tests use no network: {address}")
        connect(self, address)

    patch = pytest.MonkeyPatch()
    patch.setattr(socket.socket, "connect", local_only)
    yield
    patch.undo()


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
