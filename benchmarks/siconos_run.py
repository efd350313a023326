"""The same run by Siconos, event-driven; benchmarks/dynamics.py starts it under an interpreter that has Siconos.

The base is a third, undamped oscillator, so that the whole is one linear system and no forcing is called back in
Python. Prints one line of JSON: impacts, seconds, and the sizes of w' before the impacts.
"""

import json
import math
import sys
import time

import numpy as np
from siconos import kernel as sk


def main() -> None:
    mu, A, Omega, r, lam, periods, x1, v1, x2, v2, phase = (float(value) for value in sys.argv[1:12])
    stop = periods * 2 * math.pi / Omega
    mass = np.diag([1.0, mu, 1.0])
    stiffness = np.array([[1.0, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 0.0, Omega**2]])
    damping = np.array([[lam, 0.0, -lam], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    place = np.array([x1, x2, A * math.sin(phase)])
    speed = np.array([v1, v2, A * Omega * math.cos(phase)])
    system = sk.LagrangianLinearTIDS(place, speed, mass, stiffness, damping)
    model = sk.NonSmoothDynamicalSystem(0.0, stop)
    model.insertDynamicalSystem(system)
    kept = []
    for sign in (-1.0, 1.0):
        relation = sk.LagrangianLinearTIR(np.array([[sign, -sign, 0.0]]), np.array([1.0]))
        contact = sk.Interaction(sk.NewtonImpactNSL(r), relation)
        model.link(contact, system)
        kept += [relation, contact]
    solver = sk.LsodarOSI()
    clock = sk.TimeDiscretisation(0.0, 2 * math.pi / Omega / 20)
    run = sk.EventDriven(model, clock)
    run.insertIntegrator(solver)
    run.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_IMPACT)
    run.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_SMOOTH_ACC)
    run.setToleranceED(1e-9)
    run.initialize()
    impacts, speeds = 0, []
    began = time.perf_counter()
    while run.hasNextEvent():
        run.advanceToEvent()
        before = abs(system.velocity()[0] - system.velocity()[1])
        run.processEvents()
        after = abs(system.velocity()[0] - system.velocity()[1])
        if abs(after - r * before) < 1e-6 * before and before > 0:
            impacts += 1
            speeds.append(before)
    print(json.dumps({"impacts": impacts, "seconds": time.perf_counter() - began, "speeds": speeds}))


if __name__ == "__main__":
    main()
