"""Mobility, statics and manipulability of closed-chain mechanisms with active and passive joints.

The public names live here and are imported on first use, so that `import vincula` stays cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from vincula.analysis.ellipsoid import Ellipsoid
    from vincula.analysis.indices import (
        condition_number,
        inverse_condition_number,
        isotropy,
        smallest_singular_value,
        yoshikawa_volume,
    )
    from vincula.analysis.manipulability import (
        active_force_ellipsoid,
        dual_force_ellipsoid,
        internal_force_ellipsoid,
        kinematic_ellipsoid,
        passive_force_ellipsoid,
    )
    from vincula.analysis.result import Analysis, analyze
    from vincula.design.motor_choice import MotorChoice
    from vincula.design.placement import Placement, place
    from vincula.design.problem import DesignProblem
    from vincula.design.problems import design_problem
    from vincula.design.variables import DesignVariable
    from vincula.errors import (
        ClosureError,
        DesignError,
        DuplicateNameError,
        FileError,
        MissingExtraError,
        MissingReferenceError,
        MixedUnitsError,
        MixedUnitsWarning,
        ModelError,
        NonFiniteError,
        RankAmbiguityWarning,
        ShapeError,
        SweepError,
        TopologyError,
        UnknownNameError,
        UnsupportedFeatureError,
        VinculaError,
        WeightError,
    )
    from vincula.files.builder import FileBuilder, builder
    from vincula.files.design_file import read_design
    from vincula.files.load import load
    from vincula.files.save import save
    from vincula.kernels.compiled import CompiledMechanism
    from vincula.kernels.compiled import compile_mechanism as compile  # noqa: A004
    from vincula.kernels.evaluation import Evaluation
    from vincula.maps.map_data import SingularityMap
    from vincula.maps.singularity_map import map_over
    from vincula.maps.variables import Variable
    from vincula.mechanism.branches import Branch
    from vincula.mechanism.closed import ClosedConfiguration
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.drawing import Contact, In, Reference
    from vincula.mechanism.drawing import DrawnBody as Body
    from vincula.mechanism.drawn_joints import (
        Cylindrical,
        Fixed,
        Free,
        PlanarJoint,
        Prismatic,
        Revolute,
        Screw,
        Spherical,
        Universal,
    )
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.parts import ALL, Coupling, Cut, Drive, Limits
    from vincula.mechanism.paths import Path, PathEvent
    from vincula.mechanism.singularities import Singularity
    from vincula.model import LinearModel
    from vincula.spatial.poses import Pose
    from vincula.sweep.dataset import SweepData, open_sweep
    from vincula.sweep.merging import merge_shards
    from vincula.sweep.points import Grid, PointTable, Polyline
    from vincula.sweep.scattered import LowDiscrepancyPoints, RandomPoints
    from vincula.sweep.sweep import Sweep
    from vincula.view.design_figure import plot_design
    from vincula.view.map_figure import plot_map
    from vincula.view.placement_figure import plot_placement
    from vincula.view.plot import plot_comparison, plot_mechanism, save_figure
    from vincula.weights import Weights, characteristic_length_weights

__all__ = [
    "ALL",
    "Analysis",
    "Body",
    "Branch",
    "ClosedConfiguration",
    "ClosureError",
    "CompiledMechanism",
    "Configuration",
    "Contact",
    "Coupling",
    "Cut",
    "Cylindrical",
    "DesignError",
    "DesignProblem",
    "DesignVariable",
    "Drive",
    "DuplicateNameError",
    "Ellipsoid",
    "Evaluation",
    "FileBuilder",
    "FileError",
    "Fixed",
    "Free",
    "Grid",
    "In",
    "Limits",
    "LinearModel",
    "LowDiscrepancyPoints",
    "Mechanism",
    "MissingExtraError",
    "MissingReferenceError",
    "MixedUnitsError",
    "MixedUnitsWarning",
    "ModelError",
    "MotorChoice",
    "NonFiniteError",
    "Path",
    "PathEvent",
    "Placement",
    "PlanarJoint",
    "PointTable",
    "Polyline",
    "Pose",
    "Prismatic",
    "RandomPoints",
    "RankAmbiguityWarning",
    "Reference",
    "Revolute",
    "Screw",
    "ShapeError",
    "Singularity",
    "SingularityMap",
    "Spherical",
    "Sweep",
    "SweepData",
    "SweepError",
    "TopologyError",
    "Universal",
    "UnknownNameError",
    "UnsupportedFeatureError",
    "Variable",
    "VinculaError",
    "WeightError",
    "Weights",
    "active_force_ellipsoid",
    "analyze",
    "builder",
    "characteristic_length_weights",
    "compile",
    "condition_number",
    "design_problem",
    "dual_force_ellipsoid",
    "internal_force_ellipsoid",
    "inverse_condition_number",
    "isotropy",
    "kinematic_ellipsoid",
    "load",
    "map_over",
    "merge_shards",
    "open_sweep",
    "passive_force_ellipsoid",
    "place",
    "plot_comparison",
    "plot_design",
    "plot_map",
    "plot_mechanism",
    "plot_placement",
    "read_design",
    "save",
    "save_figure",
    "smallest_singular_value",
    "yoshikawa_volume",
]

_HOME = {
    "FileBuilder": "vincula.files.builder:FileBuilder",
    "builder": "vincula.files.builder:builder",
    "read_design": "vincula.files.design_file:read_design",
    "load": "vincula.files.load:load",
    "save": "vincula.files.save:save",
    "Ellipsoid": "vincula.analysis.ellipsoid:Ellipsoid",
    "condition_number": "vincula.analysis.indices:condition_number",
    "inverse_condition_number": "vincula.analysis.indices:inverse_condition_number",
    "isotropy": "vincula.analysis.indices:isotropy",
    "smallest_singular_value": "vincula.analysis.indices:smallest_singular_value",
    "yoshikawa_volume": "vincula.analysis.indices:yoshikawa_volume",
    "active_force_ellipsoid": "vincula.analysis.manipulability:active_force_ellipsoid",
    "dual_force_ellipsoid": "vincula.analysis.manipulability:dual_force_ellipsoid",
    "internal_force_ellipsoid": "vincula.analysis.manipulability:internal_force_ellipsoid",
    "kinematic_ellipsoid": "vincula.analysis.manipulability:kinematic_ellipsoid",
    "passive_force_ellipsoid": "vincula.analysis.manipulability:passive_force_ellipsoid",
    "Analysis": "vincula.analysis.result:Analysis",
    "analyze": "vincula.analysis.result:analyze",
    "MotorChoice": "vincula.design.motor_choice:MotorChoice",
    "Placement": "vincula.design.placement:Placement",
    "place": "vincula.design.placement:place",
    "DesignProblem": "vincula.design.problem:DesignProblem",
    "design_problem": "vincula.design.problems:design_problem",
    "DesignVariable": "vincula.design.variables:DesignVariable",
    "ClosureError": "vincula.errors:ClosureError",
    "DesignError": "vincula.errors:DesignError",
    "DuplicateNameError": "vincula.errors:DuplicateNameError",
    "FileError": "vincula.errors:FileError",
    "MissingExtraError": "vincula.errors:MissingExtraError",
    "MissingReferenceError": "vincula.errors:MissingReferenceError",
    "MixedUnitsError": "vincula.errors:MixedUnitsError",
    "MixedUnitsWarning": "vincula.errors:MixedUnitsWarning",
    "ModelError": "vincula.errors:ModelError",
    "NonFiniteError": "vincula.errors:NonFiniteError",
    "RankAmbiguityWarning": "vincula.errors:RankAmbiguityWarning",
    "ShapeError": "vincula.errors:ShapeError",
    "SweepError": "vincula.errors:SweepError",
    "TopologyError": "vincula.errors:TopologyError",
    "UnknownNameError": "vincula.errors:UnknownNameError",
    "UnsupportedFeatureError": "vincula.errors:UnsupportedFeatureError",
    "VinculaError": "vincula.errors:VinculaError",
    "WeightError": "vincula.errors:WeightError",
    "CompiledMechanism": "vincula.kernels.compiled:CompiledMechanism",
    "compile": "vincula.kernels.compiled:compile_mechanism",
    "Evaluation": "vincula.kernels.evaluation:Evaluation",
    "SingularityMap": "vincula.maps.map_data:SingularityMap",
    "map_over": "vincula.maps.singularity_map:map_over",
    "Variable": "vincula.maps.variables:Variable",
    "Branch": "vincula.mechanism.branches:Branch",
    "ClosedConfiguration": "vincula.mechanism.closed:ClosedConfiguration",
    "Configuration": "vincula.mechanism.configuration:Configuration",
    "Body": "vincula.mechanism.drawing:DrawnBody",
    "Contact": "vincula.mechanism.drawing:Contact",
    "In": "vincula.mechanism.drawing:In",
    "Reference": "vincula.mechanism.drawing:Reference",
    "Cylindrical": "vincula.mechanism.drawn_joints:Cylindrical",
    "Fixed": "vincula.mechanism.drawn_joints:Fixed",
    "Free": "vincula.mechanism.drawn_joints:Free",
    "PlanarJoint": "vincula.mechanism.drawn_joints:PlanarJoint",
    "Prismatic": "vincula.mechanism.drawn_joints:Prismatic",
    "Revolute": "vincula.mechanism.drawn_joints:Revolute",
    "Screw": "vincula.mechanism.drawn_joints:Screw",
    "Spherical": "vincula.mechanism.drawn_joints:Spherical",
    "Universal": "vincula.mechanism.drawn_joints:Universal",
    "Mechanism": "vincula.mechanism.mechanism:Mechanism",
    "ALL": "vincula.mechanism.parts:ALL",
    "Coupling": "vincula.mechanism.parts:Coupling",
    "Cut": "vincula.mechanism.parts:Cut",
    "Drive": "vincula.mechanism.parts:Drive",
    "Limits": "vincula.mechanism.parts:Limits",
    "Path": "vincula.mechanism.paths:Path",
    "PathEvent": "vincula.mechanism.paths:PathEvent",
    "Singularity": "vincula.mechanism.singularities:Singularity",
    "LinearModel": "vincula.model:LinearModel",
    "Pose": "vincula.spatial.poses:Pose",
    "Weights": "vincula.weights:Weights",
    "characteristic_length_weights": "vincula.weights:characteristic_length_weights",
    "Sweep": "vincula.sweep.sweep:Sweep",
    "SweepData": "vincula.sweep.dataset:SweepData",
    "open_sweep": "vincula.sweep.dataset:open_sweep",
    "merge_shards": "vincula.sweep.merging:merge_shards",
    "Grid": "vincula.sweep.points:Grid",
    "Polyline": "vincula.sweep.points:Polyline",
    "PointTable": "vincula.sweep.points:PointTable",
    "RandomPoints": "vincula.sweep.scattered:RandomPoints",
    "LowDiscrepancyPoints": "vincula.sweep.scattered:LowDiscrepancyPoints",
    "plot_comparison": "vincula.view.plot:plot_comparison",
    "plot_design": "vincula.view.design_figure:plot_design",
    "plot_map": "vincula.view.map_figure:plot_map",
    "plot_mechanism": "vincula.view.plot:plot_mechanism",
    "plot_placement": "vincula.view.placement_figure:plot_placement",
    "save_figure": "vincula.view.plot:save_figure",
}


def __getattr__(name: str) -> Any:
    """The public name, imported from its module now and kept."""
    home = _HOME.get(name)
    if home is None:
        raise AttributeError(f"module 'vincula' has no attribute {name!r}")
    module, _, attribute = home.partition(":")
    value = getattr(import_module(module), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
