"""`vincula warm-up` without numba; with it, it runs what the tests of kernels run."""

from __future__ import annotations


def test_without_numba_the_extra_is_named(run, monkeypatch) -> None:
    monkeypatch.setattr("vincula.kernels.warming.numba_is_installed", lambda: False)
    assert "vincula[fast]" in run("warm-up", code=2).stderr
