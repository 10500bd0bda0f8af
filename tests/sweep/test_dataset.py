"""The stored data set: opened by xarray, exported, drawn; data sets of strangers are looked at first."""

from __future__ import annotations

import csv
import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.sweep.conftest import five_bar_sweep, serial_sweep

import vincula as vc
from vincula.sweep.export import export
from vincula.sweep.ledger import MOST_REASONS

Undisturbed = Callable[[str], Path]


def test_xarray_opens_it_by_itself_and_zarr_reads_every_chunk(undisturbed: Undisturbed) -> None:
    import xarray
    import zarr

    path = undisturbed("five-bar")
    found = xarray.open_zarr(path, zarr_format=3)
    ours = five_bar_sweep().to_xarray()
    xarray.testing.assert_identical(vc.open_sweep(path).to_xarray().load(), ours)
    for name in ours.data_vars:
        assert np.array_equal(found[name].values, ours[name].values, equal_nan=True)
        assert np.array_equal(
            zarr.open_array(str(path / name), mode="r")[:], ours[name].values, equal_nan=True
        )
    assert found.attrs["model_hash"] == five_bar_sweep().manifest["model"]
    assert found.attrs["vincula_version"] == vc.__version__
    assert found["o1"].attrs["units"] == "rad"
    assert found["closure.residual"].attrs["units"] == "m"


def test_labels(undisturbed: Undisturbed) -> None:
    found = vc.open_sweep(undisturbed("serial")).to_xarray()
    assert list(found["count"].values) == [
        "ar",
        "pr",
        "oi",
        "t",
        "ap",
        "ao",
        "po",
        "g",
        "a",
        "p",
        "o",
        "none",
    ]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"codecs": [{"name": "numcodecs.pickle", "configuration": {}}]}, "codec 'numcodecs.pickle'"),
        ({"codecs": [{"name": "bytes"}, {"name": "vlen-utf8"}]}, "codec 'vlen-utf8'"),
        ({"codecs": "bytes"}, "codec None"),
        ({"data_type": "variable_length_utf8"}, "expected numbers"),
        ({"data_type": {"name": "struct"}}, "expected numbers"),
        ({"storage_transformers": [{"name": "x"}]}, "storage transformers"),
        ({"node_type": "group"}, "is no array"),
    ],
)
def test_foreign_codecs_and_types_are_refused(change: dict[str, Any], words: str, tmp_path: Path) -> None:
    """In the array's own description, and in the consolidated one."""
    path = serial_sweep().run(tmp_path / "a.zarr").path
    own, root = path / "counts" / "zarr.json", path / "zarr.json"
    before = own.read_text(), root.read_text()
    own.write_text(json.dumps({**json.loads(before[0]), **change}))
    with pytest.raises(vc.SweepError, match=words):
        vc.open_sweep(path)
    own.write_text(before[0])
    whole = json.loads(before[1])
    whole["consolidated_metadata"]["metadata"]["counts"] |= change
    root.write_text(json.dumps(whole))
    with pytest.raises(vc.SweepError, match=words):
        vc.open_sweep(path).to_xarray()
    root.write_text(before[1])
    vc.open_sweep(path)


class Boom:
    """Runs code when it is unpickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return (Path("/nowhere/boom").touch, ())


def test_zarr_2_with_a_pickle_filter_is_never_opened(tmp_path: Path) -> None:
    folder = tmp_path / "evil.zarr"
    (folder / "a").mkdir(parents=True)
    (folder / ".zgroup").write_text('{"zarr_format": 2}')
    (folder / "a" / ".zarray").write_text(
        json.dumps({"zarr_format": 2, "shape": [1], "chunks": [1], "dtype": "|O", "compressor": None,
                    "fill_value": None, "order": "C", "filters": [{"id": "pickle"}]})
    )  # fmt: skip
    (folder / "a" / "0").write_bytes(pickle.dumps(Boom()))
    with pytest.raises(vc.SweepError, match="zarr 2"):
        vc.open_sweep(folder)


@pytest.mark.parametrize("text", ["", "[]", "{", '{"attributes": 3}', '{"attributes": {"schema": "other"}}'])
def test_other_groups_are_refused(text: str, tmp_path: Path) -> None:
    folder = tmp_path / "a.zarr"
    folder.mkdir()
    (folder / "zarr.json").write_text(text)
    with pytest.raises(vc.SweepError, match="no data set of vincula"):
        vc.open_sweep(folder)
    with pytest.raises(vc.SweepError, match="no such data set"):
        vc.open_sweep(tmp_path / "none.zarr")


def test_links_in_a_data_set_are_refused(tmp_path: Path) -> None:
    path = serial_sweep().run(tmp_path / "a.zarr").path
    (path / "more").symlink_to(tmp_path)
    with pytest.raises(vc.SweepError, match="is a link"):
        vc.open_sweep(path)


def test_csv_has_a_row_for_every_point(tmp_path: Path, undisturbed: Undisturbed) -> None:
    data = vc.open_sweep(undisturbed("five-bar"))
    found = data.to_xarray().load()
    with export(data, tmp_path / "a.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == found["status"].size
    words = {0: "ok", 3: "no-closure"}
    for k, row in enumerate(rows):
        i, j = divmod(k, found.sizes["o5"])
        assert float(row["o1"]) == float(found["o1"][i])
        assert float(row["o5"]) == float(found["o5"][j])
        assert row["status"] == words[int(found["status"][i, j])]
        value = float(row["kinematic.efficiencies[1]"])
        assert np.array_equal(value, float(found["kinematic.efficiencies"][i, j, 1]), equal_nan=True)
        assert np.array_equal(
            float(row["configuration[o2]"]), float(found["configuration"][i, j, 1]), equal_nan=True
        )


def test_csv_in_slabs_is_the_same(
    tmp_path: Path, undisturbed: Undisturbed, monkeypatch: pytest.MonkeyPatch
) -> None:
    import vincula.sweep.export as exporting

    data = vc.open_sweep(undisturbed("serial"))
    whole = export(data, tmp_path / "a.csv").read_text()
    for slab in (1, 7, 25):
        monkeypatch.setattr(exporting, "SLAB", slab)
        assert export(data, tmp_path / f"{slab}.csv").read_text() == whole


def test_netcdf_holds_the_same_numbers(tmp_path: Path, undisturbed: Undisturbed) -> None:
    import xarray

    data = vc.open_sweep(undisturbed("five-bar"))
    path = export(data, tmp_path / "a.nc")
    ours = data.to_xarray().load()
    with xarray.open_dataset(path) as found:
        for name in ours.data_vars:
            assert np.array_equal(found[name].values, ours[name].values, equal_nan=True)
        assert found.attrs["model_hash"] == ours.attrs["model_hash"]


def test_exports_refuse(tmp_path: Path, undisturbed: Undisturbed) -> None:
    data = vc.open_sweep(undisturbed("serial"))
    (tmp_path / "a.csv").write_text("mine")
    with pytest.raises(vc.SweepError, match="there is a file already"):
        export(data, tmp_path / "a.csv")
    with pytest.raises(vc.SweepError, match=r"ends in .nc, .csv, .parquet"):
        export(data, tmp_path / "a.xlsx")
    with pytest.raises(vc.SweepError, match="cannot be stored"):
        export(data, tmp_path / "none" / "a.csv")
    assert export(data, tmp_path / "a.csv", overwrite=True).read_text() != "mine"


def test_parquet(tmp_path: Path, undisturbed: Undisturbed) -> None:
    data = vc.open_sweep(undisturbed("serial"))
    try:
        from pyarrow import parquet
    except ImportError:
        with pytest.raises(vc.MissingExtraError, match="parquet"):
            export(data, tmp_path / "a.parquet")
        return
    table = parquet.read_table(export(data, tmp_path / "a.parquet"))
    found = data.to_xarray()
    assert np.array_equal(table["kinematic.smallest"].to_numpy(), found["kinematic.smallest"].values.ravel())


def test_the_accessor(undisturbed: Undisturbed) -> None:
    found = vc.open_sweep(undisturbed("five-bar")).to_xarray()
    status = found["status"].values
    assert found.vincula.counts == {**dict.fromkeys(("doubtful", "open", "failed", "not-done"), 0),
                                    "ok": (status == 0).sum(), "no-closure": (status == 3).sum()}  # fmt: skip
    assert (found.vincula.status.values == np.where(status == 0, "ok", "no-closure")).all()
    index = found.vincula.index("kinematic.efficiencies", entry=1)
    assert np.isnan(index.values[status == 3]).all()
    assert np.isfinite(index.values[status == 0]).all()
    assert found.vincula.index("configuration", coordinate="o3").dims == ("o1", "o5")
    with pytest.raises(vc.ModelError, match="choose one"):
        found.vincula.index("kinematic.efficiencies")
    with pytest.raises(vc.UnknownNameError):
        found.vincula.index("kinematic.speed")
    assert found.vincula.slice(o1=0.0)["o1"].ndim == 0


def test_pictures(undisturbed: Undisturbed) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    found = vc.open_sweep(undisturbed("five-bar")).to_xarray()
    ax = found.vincula.map("kinematic.efficiencies", "o1", "o5", entry=0, logarithmic=True)
    assert ax.get_xlabel() == "o1 [deg]"
    drawn = np.ma.filled(ax.collections[0].get_array(), np.nan).reshape(9, 6)
    expected = found.vincula.index("kinematic.efficiencies", entry=0).transpose("o5", "o1").values
    assert np.array_equal(np.isnan(drawn), np.isnan(expected))
    assert "does not close" in ax.get_title(loc="right")
    curve = found.vincula.curve("closure.residual", "o5", at={"o1": 0.0})
    assert len(curve.lines[0].get_xdata()) == 9
    serial = vc.open_sweep(undisturbed("serial")).to_xarray()
    one, two = serial["status"].dims
    serial.vincula.singularities(one, two)
    with pytest.raises(vc.ModelError, match="two variables"):
        found.vincula.map("closure.residual", "o1", "o1")
    pyplot.close("all")


def test_reasons_beyond_those_that_are_kept(tmp_path: Path) -> None:
    """Every open point has a reason of its own; of a chunk the first ones are kept, and that is said."""
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    count = MOST_REASONS + 20
    points = {"o1": [-0.05], "o5": [0.0, *np.linspace(0.2, 3.1, count)]}
    data = vc.Sweep(linkage, points, ["summary"], given="configuration").run(tmp_path / "a.zarr")
    assert data.status().counts["open"] == count + 1
    assert "open" in data.reason((0, 0))
    assert data.reason((0, 5)) != data.reason((0, 6))
    assert f"first {MOST_REASONS} reasons" in data.reason((0, count))
