"""`vincula warm-up` without numba; with it, it runs what the tests of kernels run."""

from __future__ import annotations

from pathlib import Path

import pytest

from vincula.cli.warming import tell_first_wait


def test_without_numba_the_extra_is_named(run, monkeypatch) -> None:
    monkeypatch.setattr("vincula.kernels.warming.numba_is_installed", lambda: False)
    assert "vincula[fast]" in run("warm-up", code=2).stderr


def test_a_first_wait_is_told_and_a_later_one_is_none(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("vincula.kernels.warming.numba_is_installed", lambda: True)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    tell_first_wait(quiet=True)
    assert capsys.readouterr().err == ""
    tell_first_wait(quiet=False)
    assert "vincula warm-up" in capsys.readouterr().err
    (tmp_path / "lanes_1").mkdir()
    (tmp_path / "lanes_1" / "entries.spectra_entry.locals.run-1.py311.nbi").touch()
    tell_first_wait(quiet=False)
    assert capsys.readouterr().err == ""


def test_numba_keeps_kernels_under_the_name_that_is_looked_for() -> None:
    """The name is numba's own; if it changed, nobody would be told."""
    pytest.importorskip("numba")
    from vincula.kernels.lanes.entries import spectra_entry

    path = Path(spectra_entry(1)._cache._cache_file._index_path)
    assert path.match("entries.spectra_entry.*.nbi")
