"""The least time of examples/fan.toml within the velocities and accelerations of examples/machine.toml, as `toppra` (PyPI) finds it.

    pip install toppra scipy
    python3 tests/peers/toppra_fan.py [GRIDPOINTS]

Prints the seconds from rest to rest. The spline is the job's: a closed cubic, parametrised by chord length, through its points. The job's
feed limits the way along the curve, which is a third coordinate here: its length, whose acceleration nothing limits.
"""

import logging
import pathlib
import sys
import tomllib

import numpy as np
import toppra
import toppra.algorithm
import toppra.constraint
from scipy.interpolate import CubicSpline

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
# Points of the length between two points of the job.
DENSE = 64


def load(name):
    return tomllib.loads((EXAMPLES / name).read_text())


def main():
    gridpoints = int(sys.argv[1]) if len(sys.argv) > 1 else 16_000
    logging.disable(logging.CRITICAL)
    job, machine = load("fan.toml"), load("machine.toml")
    spline = job["segment"][0]["spline"]
    points = np.array([spline["start"], *spline["points"]])
    chords = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    curve = CubicSpline(chords, points, bc_type="periodic")
    dense = np.concatenate([np.linspace(a, b, DENSE, endpoint=False) for a, b in zip(chords, chords[1:])] + [chords[-1:]])
    # The length by Gauss-Legendre over each dense step.
    nodes, weights = np.polynomial.legendre.leggauss(6)
    half = np.diff(dense)[:, None] / 2
    at = (dense[:-1, None] + half) + half * nodes
    length = np.concatenate([[0], np.cumsum((np.linalg.norm(curve(at, 1), axis=-1) * weights * half).sum(axis=1))])
    with_length = CubicSpline(dense, np.column_stack([curve(dense), length]))
    path = toppra.SplineInterpolator(dense, with_length(dense))
    axes = {axis["name"]: axis for axis in machine["axis"]}
    velocity = [axes["x"]["velocity"], axes["y"]["velocity"], job["feed"]["rate"] / 60]
    acceleration = [axes["x"]["acceleration"], axes["y"]["acceleration"], 1e9]
    both = lambda values: np.array([[-value, value] for value in values])
    constraints = [
        toppra.constraint.JointVelocityConstraint(both(velocity)),
        toppra.constraint.JointAccelerationConstraint(
            both(acceleration), discretization_scheme=toppra.constraint.DiscretizationType.Interpolation
        ),
    ]
    grid = np.linspace(0, chords[-1], gridpoints + 1)
    instance = toppra.algorithm.TOPPRA(constraints, path, gridpoints=grid, solver_wrapper="seidel")
    sdd, sd, _ = instance.compute_parameterization(0, 0)
    print(2 * np.sum(np.diff(grid) / (sd[1:] + sd[:-1])))


main()
