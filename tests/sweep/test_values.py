"""What a sweep stores is what the ordinary functions say at the same configurations."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.kernels.quantities import KINDS


def test_motors_close_the_loops() -> None:
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    over = {"o5": np.radians([-6.0, -3.0, 0.0]), "o1": np.radians([-4.0, 0.0])}
    found = vc.Sweep(linkage, over, ["kinematic.efficiencies", "counts", "configuration"]).to_xarray()
    assert found["status"].dims == ("o5", "o1")
    for i, o5 in enumerate(over["o5"]):
        for j, o1 in enumerate(over["o1"]):
            q = linkage.close(motors={"o1": o1, "o5": o5})
            analysis = vc.analyze(linkage.linearize(q), vc.Weights())
            here = found.isel(o5=i, o1=j)
            expected = analysis.kinematic.efficiencies
            assert here["kinematic.efficiencies"].values[: len(expected)] == pytest.approx(expected, rel=1e-9)
            assert float(here["configuration"].sel(coordinate="o1")) == pytest.approx(o1, abs=1e-12)
            assert dict(zip(found["count"].values, here["counts"].values, strict=True))["g"] == 2


def test_a_motor_that_is_not_swept_stands_at_the_start() -> None:
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    found = vc.Sweep(
        linkage, {"o1": [-0.05, 0.0]}, ["configuration"], start={"o1": -0.1, "o5": -0.1}
    ).to_xarray()
    start = linkage.close({"o1": -0.1, "o5": -0.1})
    assert found["configuration"].sel(coordinate="o5").values == pytest.approx(float(start["o5"][0]))
    assert found["configuration"].sel(coordinate="o1").values == pytest.approx([-0.05, 0.0])


def test_poses_of_the_reference_member() -> None:
    platform = vc.load("example:stewart", {"alpha": "10deg", "beta": "-110deg"})
    over = {"reference.z": [1.95, 2.0], "reference.yaw": np.radians([-3.0, 4.0])}
    found = vc.Sweep(platform, over, ["reference.pose", "closure.residual"]).to_xarray()
    assert not found["status"].any()
    assert found["closure.residual"].values.max() < 1e-12
    for i, z in enumerate(over["reference.z"]):
        for j, yaw in enumerate(over["reference.yaw"]):
            pose = found["reference.pose"].values[i, j]
            expected = [0, 0, z, np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]
            assert np.abs(pose * np.sign(pose[3]) - expected).max() < 1e-9


def test_parameters_change_the_geometry() -> None:
    def build(radius: float = 1.5) -> vc.Mechanism:
        return vc.load("example:stewart", {"alpha": "10deg", "beta": "-110deg", "upper_radius": radius})

    found = vc.Sweep(
        build, {"radius": [1.2, 1.5, 1.8]}, ["kinematic.smallest"], weights=vc.Weights()
    ).to_xarray()
    for radius, value in zip([1.2, 1.5, 1.8], found["kinematic.smallest"].values, strict=True):
        expected = vc.kinematic_ellipsoid(build(radius).linearize(), vc.Weights()).efficiencies
        assert value == pytest.approx(expected.min(), rel=1e-9)


def test_a_serial_arm_takes_joint_values_as_they_are() -> None:
    arm = vc.load("example:serial-2r")
    one, two = arm.home
    table = {one: [0.1, 0.2, 0.3], two: [1.0, 0.5, -0.7]}
    found = vc.Sweep(arm, vc.PointTable(table), ["kinematic.yoshikawa_volume:translation"]).to_xarray()
    assert found["status"].dims == ("point",)
    assert found[one].values == pytest.approx(table[one])
    for k in range(3):
        model = arm.linearize({one: table[one][k], two: table[two][k]})
        assert float(found["kinematic.yoshikawa_volume:translation".replace(":", ".")][k]) == pytest.approx(
            vc.yoshikawa_volume(model, "translation")
        )


def test_stretches_do_not_change_what_is_computed(rng: np.random.Generator) -> None:
    """A chunk of many stretches against points closed one by one from the start."""
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    ranges = {"o1": (-0.12, 0.0), "o5": (-0.12, 0.0)}
    sweep = vc.Sweep(linkage, vc.RandomPoints(ranges, 100, 5), ["configuration"], chunk=100)
    found = sweep.to_xarray()
    assert not found["status"].any()
    for k in rng.choice(100, 10, replace=False):
        q = linkage.close(motors={"o1": float(found["o1"][k]), "o5": float(found["o5"][k])})
        expected = np.concatenate([np.ravel(v) for v in q.values()])
        assert found["configuration"].values[k] == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize(
    ("over", "options", "words"),
    [
        ({"o3": [0.0]}, {}, "no motors, and loops are closed"),
        ({"o9": [0.0]}, {}, "'o9'"),
        ({"reference.x": [0.0], "o1": [0.0]}, {}, "cannot be given as well"),
        ({"reference.roll": [0.0]}, {}, "reference.angle"),
        ({"parameter.l": [0.0]}, {}, "parameter"),
        ({"o1": [0.0]}, {"given": "angles"}, "choose"),
        ({"o1": [0.0]}, {"quantities": ["kinematic.speed"]}, "no quantity is named"),
    ],
)
def test_variables_that_cannot_be_used(
    over: dict[str, list[float]], options: dict[str, object], words: str
) -> None:
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    with pytest.raises(vc.ModelError, match=words):
        vc.Sweep(linkage, over, **options)  # type: ignore[arg-type]


def test_one_axis_by_two_names_is_refused() -> None:
    leg = vc.load("example:stewart")
    axis = "reference.qw"
    with pytest.raises(vc.ModelError, match="all four numbers"):
        vc.Sweep(leg, {axis: [1.0]})
    with pytest.raises(vc.ModelError, match="cannot be given as well"):
        vc.Sweep(leg, {axis: [1.0], "reference.roll": [0.0]})


def test_every_kind_of_ellipsoid_can_be_asked_for() -> None:
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    names = [f"{kind}.efficiencies" for kind in KINDS]
    found = vc.Sweep(linkage, {"o1": [-0.05]}, names).to_xarray()
    assert set(names) < set(found.data_vars)
