"""Native files that several tests read."""

from __future__ import annotations

from pathlib import Path

FIVE_BAR = """
vincula: 1
space: planar
parameters: {l: 1.0}
joints:
  - {name: o1, type: revolute, bodies: [ground, crank], at: [-$l, -2*$l]}
  - {name: o2, type: revolute, bodies: [crank, coupler], at: [-$l, 0]}
  - {name: o3, type: revolute, bodies: [coupler, link], at: [0, 0]}
  - {name: o4, type: revolute, bodies: [link, rocker], at: [$l, -$l]}
  - {name: o5, type: revolute, bodies: [rocker, ground], at: [$l, -2*$l]}
motors: [o1, o5]
reference: {body: coupler, origin: [-$l/2, 0], cuts: {o2: {at: [-2*$l/3, 0]}, o3: {at: [-$l/3, 0]}}}
weights: {}
"""


ALL_JOINTS = """
vincula: 1
space: spatial
bodies:
  plate: {}
  tool: {fixed_to: hand, at: [3, 2, 1]}
frames:
  tip: {body: tool, at: [3, 2, 2], z: [1, 0, 0], x: [0, 0, 1]}
joints:
  - {name: r, type: revolute, bodies: [ground, b1], at: [0, 0, 1], axis: [0, 3, 4]}
  - {name: p, type: prismatic, bodies: [b1, b2], axis: [1, 0, 0]}
  - {name: s, type: screw, bodies: [b2, b3], at: [1, 0, 0], axis: [0, 0, 1], lead: -0.01}
  - {name: c, type: cylindrical, bodies: [b3, b4], at: [1, 1, 0], axis: [0, 1, 1]}
  - {name: u, type: universal, bodies: [b4, b5], at: [1, 1, 1], axes: [[1, 0, 0], [0, 1, 0]]}
  - {name: k, type: spherical, bodies: [b5, b6], at: [2, 1, 1]}
  - {name: e, type: planar, bodies: [b6, b7], at: [2, 2, 1], axis: [1, 1, 1]}
  - {name: f, type: fixed, bodies: [b7, hand]}
  - {name: fl, type: free, bodies: [ground, plate], at: [0, 0, 5]}
  - {name: v, type: revolute, bodies: [plate, vane], at: &tip {in: tip, xyz: [0, 0, 1]}, axis: *tip}
contacts:
  - {name: c1, type: line-friction, bodies: [tool, plate], at: [3, 2, 2], normal: [0, 0, 2], line: [1, 1, 0],
     friction: 0.5}
  - {name: c2, type: soft-finger, bodies: [vane, tool], at: {in: tip, xyz: [0, 0, 0.5]}, normal: [1, 0, 0]}
motors: [r, c.translation, u.2, k]
lock: [s]
reference: {body: plate, origin: {in: tip, xyz: [0, 0, 0]}, axes: body}
"""


def write(folder: Path, text: str, name: str = "model.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
