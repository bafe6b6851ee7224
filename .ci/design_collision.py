"""Least distances of a designed motion by Pinocchio and Coal, on the shapes of the URDF themselves.

    pip install pin && python .ci/design_collision.py examples/cell/design.toml DIR

DIR is what `thetahat design` wrote. Capsules hold the shapes that they are around, so that no distance here is below the margin.
"""

import csv
import sys
import tomllib
from pathlib import Path

import coal
import numpy as np
import pinocchio

# Half of the edge of the box that stands for what is behind a plane, m.
BEHIND = 5.0


def obstacle(options):
    """Shape and placement of an obstacle of the design."""
    turned = pinocchio.rpy.rpyToMatrix(*np.radians(options.get("rpy", [0, 0, 0])))
    if options["kind"] == "plane":
        normal = np.array(options["normal"], float) / np.linalg.norm(options["normal"])
        turned = pinocchio.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), normal).matrix()
        centre = np.array(options.get("point", [0, 0, 0])) / 1e3 - BEHIND * normal
        return coal.Box(2 * BEHIND, 2 * BEHIND, 2 * BEHIND), pinocchio.SE3(turned, centre)
    centre = np.array(options["centre"]) / 1e3
    if options["kind"] == "box":
        return coal.Box(*(edge / 1e3 for edge in options["edges"])), pinocchio.SE3(turned, centre)
    return coal.Cylinder(options["radius"] / 1e3, options["length"] / 1e3), pinocchio.SE3(turned, centre)


def scene(design, folder):
    """Model and geometry with the pairs that must stay apart."""
    urdf = str(folder / design["robot"])
    model = pinocchio.buildModelFromUrdf(urdf)
    geometry = pinocchio.buildGeomFromUrdf(model, urdf, pinocchio.GeometryType.COLLISION)
    for options in design["collision"]["obstacles"]:
        shape, placement = obstacle(options)
        geometry.addGeometryObject(pinocchio.GeometryObject(options["name"], 0, 0, placement, shape))
    ignored = {frozenset(pair) for pair in design["collision"].get("ignore", [])}
    names = [g.name.rsplit("_", 1)[0] if g.name.rsplit("_", 1)[-1].isdigit() else g.name for g in geometry.geometryObjects]
    joints = [g.parentJoint for g in geometry.geometryObjects]
    for i, first in enumerate(joints):
        for j in range(i + 1, len(joints)):
            second = joints[j]
            is_obstacle = j >= len(joints) - len(design["collision"]["obstacles"])
            are_neighbours = model.parents[first] == second or model.parents[second] == first
            near = first == second or (are_neighbours and not is_obstacle)
            if not near and frozenset((names[i], names[j])) not in ignored:
                geometry.addCollisionPair(pinocchio.CollisionPair(i, j))
    return model, geometry, names


def main():
    path, directory = Path(sys.argv[1]), Path(sys.argv[2])
    design = tomllib.loads(path.read_text())
    model, geometry, names = scene(design, path.parent)
    data, placed = model.createData(), geometry.createData()
    with open(directory / "trajectory.csv", newline="") as file:
        rows = list(csv.reader(file))
    columns = [k for k, name in enumerate(rows[0]) if name.startswith("q_")]
    least, where = np.inf, None
    for row in rows[1:]:
        q = np.array([float(row[k]) for k in columns])
        pinocchio.computeDistances(model, data, geometry, placed, q)
        for pair, result in zip(geometry.collisionPairs, placed.distanceResults):
            if result.min_distance < least:
                least, where = result.min_distance, (names[pair.first], names[pair.second], row[0])
    margin = design["collision"]["margin"]
    print(f"{len(geometry.collisionPairs)} pairs, {len(rows) - 1} samples: least {1e3 * least:.2f} mm, {where}; margin {margin} mm")
    sys.exit(0 if 1e3 * least >= margin else 1)


if __name__ == "__main__":
    main()
