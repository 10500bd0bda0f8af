"""Figures: three formats, the same bytes every time, what must be read on them, and what is refused."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import vincula as vc
from vincula.mechanism.catalog.registry import example

matplotlib = pytest.importorskip("matplotlib")

from vincula.view import style  # noqa: E402
from vincula.view.plot import (  # noqa: E402
    motors_text,
    plot_comparison,
    plot_mechanism,
    save_figure,
)

KME = ["kinematic"]


def texts(figure: object) -> list[str]:
    """Every text on a figure."""
    return [t.get_text() for t in figure.findobj(matplotlib.text.Text) if t.get_text()]


def legend(figure: object) -> list[str]:
    return [t.get_text() for t in figure.legends[0].get_texts()]


@pytest.mark.parametrize(
    ("ending", "start"), [(".svg", b"<?xml"), (".png", b"\x89PNG\r\n\x1a\n"), (".pdf", b"%PDF-")]
)
@pytest.mark.parametrize("name", ["five-bar", "stewart"])
def test_three_formats_in_the_plane_and_in_space(
    tmp_path: Path, name: str, ending: str, start: bytes
) -> None:
    written = save_figure(plot_mechanism(example(name), ellipsoids=["kinematic"]), tmp_path / f"a{ending}")
    assert written.read_bytes().startswith(start)
    assert written.stat().st_size > 5000


@pytest.mark.parametrize("ending", [".svg", ".pdf", ".png"])
def test_the_same_bytes_every_time(tmp_path: Path, ending: str) -> None:
    twice = [
        save_figure(
            plot_mechanism(example("five-bar"), ellipsoids=KME), tmp_path / f"{k}{ending}"
        ).read_bytes()
        for k in (1, 2)
    ]
    assert twice[0] == twice[1]


def test_another_process_writes_the_same_svg(tmp_path: Path) -> None:
    code = (
        "import sys; from vincula.mechanism.catalog.registry import example;"
        "from vincula.view.plot import plot_mechanism, save_figure;"
        "save_figure(plot_mechanism(example('3rrr')), sys.argv[1]);"
        "sys.exit('matplotlib.pyplot' in sys.modules)"
    )
    other = tmp_path / "other.svg"
    done = subprocess.run(
        [sys.executable, "-c", code, str(other)], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    here = save_figure(plot_mechanism(example("3rrr")), tmp_path / "here.svg")
    assert here.read_bytes() == other.read_bytes()
    assert b"<dc:date>" not in here.read_bytes()


def test_settings_of_the_user_are_left_alone(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    save_figure(plot_mechanism(example("five-bar"), ellipsoids=[]), tmp_path / "a.svg")
    assert dict(matplotlib.rcParams) == before


def test_settings_of_the_user_do_not_change_the_figure(tmp_path: Path) -> None:
    plain = save_figure(plot_mechanism(example("five-bar")), tmp_path / "plain.svg").read_bytes()
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "black", "svg.hashsalt": "else"}):
        styled = save_figure(plot_mechanism(example("five-bar")), tmp_path / "styled.svg").read_bytes()
    assert styled == plain


def test_a_figure_of_the_five_bar_says_what_it_shows() -> None:
    figure = plot_mechanism(example("five-bar").with_active("o1,o5"))
    found = texts(figure)
    for name in ("(a) KME", "(b) AFME", "(c) PFME", "(d) OWFME", "x [m]", "y [m]", "o1", "o5"):
        assert name in found
    assert "λ = 9.74, 0.514" in found
    assert found.count("λ = 1.95, 0.103") == 2
    assert "λ = ∞, 1.95, 0.103" in found
    assert any(text.startswith("∞ along (0, ") and "0.89" in text and "0.45" in text for text in found)
    assert any(text.startswith("1 m/s = ") for text in found)
    assert any(text.startswith("1 N = ") for text in found)
    assert legend(figure) == [
        "revolute, motor",
        "revolute, passive",
        "member: coupler",
        "reference point",
        "unbounded line",
    ]


def test_motors_are_black_and_passive_joints_white() -> None:
    figure = plot_mechanism(example("five-bar").with_active("o1,o5"), ellipsoids=[])
    fills = {
        (float(line.get_xdata()[0]), float(line.get_ydata()[0])): line.get_markerfacecolor()
        for line in figure.axes[0].lines
        if line.get_marker() == "o"
    }
    assert fills == {
        (-1, -2): style.INK,
        (-1, 0): "white",
        (0, 0): "white",
        (1, -1): "white",
        (1, -2): style.INK,
    }


def test_spatial_figures_have_labelled_axes_and_contacts() -> None:
    figure = plot_mechanism(example("stewart"))
    assert {axes.name for axes in figure.axes} == {"3d"}
    assert {"x [m]", "y [m]", "z [m]", "(a) KME", "p1", "b6"} <= set(texts(figure))
    assert {"prismatic, motor", "spherical, passive", "contact (soft-finger)"} <= set(legend(figure))


def test_the_ellipsoid_is_drawn_at_the_reference_point() -> None:
    figure = plot_mechanism(example("five-bar"), ellipsoids=["kinematic"])
    (outline,) = [
        line for line in figure.axes[0].lines if line.get_color() == style.KINDS["kinematic"].colour
    ]
    points = outline.get_xydata()[:-1]
    np.testing.assert_allclose(points.mean(axis=0), [-0.5, 0.0], atol=1e-12)


def test_a_comparison_has_a_row_a_design_at_one_scale() -> None:
    figure = plot_comparison(example("five-bar"), ["o1,o5", "o2,o4", vc.ALL])
    found = texts(figure)
    assert len(figure.axes) == 12
    for header in ("motors o1, o5", "motors o2, o4", "all 5 joint axes driven"):
        assert header in found
    assert len({text for text in found if text.startswith("1 m/s = ")}) == 1
    windows = {(*axes.get_xlim(), *axes.get_ylim()) for axes in figure.axes}
    assert len(windows) == 1


def test_panels_do_not_overlap_and_stay_on_the_sheet() -> None:
    for figure in (
        plot_mechanism(example("five-bar")),
        plot_comparison(example("3rrr"), ["a1,a2,a3", "all"]),
    ):
        boxes = [axes.get_position(original=True) for axes in figure.axes]
        for k, one in enumerate(boxes):
            assert 0 <= one.x0 < one.x1 <= 1
            assert 0 <= one.y0 < one.y1 <= 1
            assert not any(one.overlaps(other) for other in boxes[k + 1 :])


def test_names_of_the_five_bar_cover_neither_joints_nor_each_other() -> None:
    figure = plot_mechanism(example("five-bar"), ellipsoids=[])
    canvas = matplotlib.backends.backend_agg.FigureCanvasAgg(figure)
    canvas.draw()
    axes = figure.axes[0]
    boxes = [t.get_window_extent() for t in axes.texts]
    assert len(boxes) == 5
    for k, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[k + 1 :])
        for point in ((-1, -2), (-1, 0), (0, 0), (1, -1), (1, -2)):
            assert not box.contains(*axes.transData.transform(point))
        assert axes.get_window_extent().contains(box.x0, box.y0)
        assert axes.get_window_extent().contains(box.x1, box.y1)


def test_without_a_reference_member_the_mechanism_is_drawn_alone() -> None:
    bar = vc.Mechanism.planar(joints=[vc.Revolute("a", "ground", "bar", at=(0, 0))])
    assert len(plot_mechanism(bar).axes) == 1
    with pytest.raises(vc.MissingReferenceError):
        plot_mechanism(bar, ellipsoids=["kinematic"])


def test_a_doubtful_rank_is_told_on_the_figure() -> None:
    near = example("stewart", alpha="10deg", beta="10.00000000001deg")
    with pytest.warns(vc.RankAmbiguityWarning):
        figure = plot_mechanism(near, ellipsoids=["kinematic"])
    assert "A rank is doubtful here" in " ".join(texts(figure))


def test_open_loops_are_drawn_alone_but_have_no_ellipsoids() -> None:
    mechanism = example("five-bar")
    assert plot_mechanism(mechanism, {"o1": 0.2}, ellipsoids=[]).axes
    with pytest.raises(vc.ClosureError):
        plot_mechanism(mechanism, {"o1": 0.2})


def test_wrong_requests_are_refused_with_the_choices(tmp_path: Path) -> None:
    mechanism = example("five-bar")
    with pytest.raises(vc.UnknownNameError, match="kinematic, active force, passive force, dual force"):
        plot_mechanism(mechanism, ellipsoids=["internal force"])
    with pytest.raises(vc.UnknownNameError, match=r"\.svg, \.png, \.pdf"):
        save_figure(plot_mechanism(mechanism, ellipsoids=[]), tmp_path / "figure.bmp")
    with pytest.raises(vc.ModelError, match="at least one choice of motors"):
        plot_comparison(mechanism, [])
    with pytest.raises(vc.UnknownNameError, match="o9"):
        plot_comparison(mechanism, ["o9"])


def test_without_matplotlib_the_install_command_is_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(vc.MissingExtraError, match=r"pip install 'vincula\[plot\]'"):
        plot_mechanism(example("five-bar"))


@pytest.mark.parametrize(
    ("motors", "words"),
    [
        ((), "no motors"),
        (("o1",), "motors o1"),
        (("o1", "o5"), "motors o1, o5"),
        ("all", "all 5 joint axes driven"),
    ],
)
def test_motors_in_a_line(motors: object, words: str) -> None:
    assert motors_text(example("five-bar").with_active(motors)) == words


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e4])
def test_any_size_no_motors_strange_names_and_locks_are_drawn(tmp_path: Path, scale: float) -> None:
    arm = vc.Mechanism.spatial(
        joints=[
            vc.Revolute("a$b_{", "ground", "one", at=(0, 0, 0), axis=(0, 0, 1)),
            vc.Screw("_twist", "one", "two", at=(scale, 0, 0), axis=(1, 0, 0), lead=0.1 * scale),
            vc.Cylindrical("<&>", "two", "three", at=(scale, scale, 0), axis=(0, 1, 1)),
            vc.PlanarJoint("p", "three", "four", at=(0, scale, scale)),
            vc.Fixed("f", "four", "five", at=(0, scale, 2 * scale)),
        ],
        reference=vc.Reference("five", origin=(0, 0, 2 * scale)),
        lock=["_twist"],
        weights=vc.Weights(),
    )
    for motors in ((), ["a$b_{"], vc.ALL):
        figure = plot_mechanism(arm.with_active(motors), width=5.0)
        save_figure(figure, tmp_path / "odd.svg")
    assert "a$b_{" in texts(figure)
    assert "screw, locked" in legend(figure)


def test_a_single_point_is_drawn() -> None:
    for maker in (vc.Mechanism.planar, vc.Mechanism.spatial):
        assert plot_mechanism(
            maker(
                joints=[
                    vc.Revolute("a", "ground", "bar", at=(3,) * 2 + (0,) * (maker is vc.Mechanism.spatial))
                ]
            )
        ).axes
