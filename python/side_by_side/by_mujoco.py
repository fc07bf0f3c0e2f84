"""MuJoCo's sysid: a position servo with a delay and a limit of its force, fitted as a machine.

Its intervals are those of the parameters: the bounds of the step response follow from their covariance, by differences.
"""

import mujoco
import numpy as np
from answer import Answer, padded
from mujoco import rollout, sysid

QUANTILE_99 = 2.5758
SERVO = """
<mujoco>
  <option timestep="{period}" integrator="RK4"><flag contact="disable" gravity="disable"/></option>
  <worldbody><body>
    <inertial pos="0 0 0" mass="1" diaginertia="1e-9 1e-9 1e-9"/>
    <joint name="shaft" type="hinge" axis="0 0 1" armature="1"/>
  </body></worldbody>
  <actuator>
    <position name="servo" joint="shaft" kp="1000" kv="50" forcerange="-1e9 1e9" delay="0.01" nsample="64" interp="linear"/>
  </actuator>
  <sensor><jointpos name="angle" joint="shaft"/></sensor>
</mujoco>
"""


# Name, unit in which it is searched, start, smallest, largest.
QUANTITIES = (
    ("stiffness", 1e3, 1.0, 0.05, 20.0),
    ("damping", 1e2, 0.5, 0.05, 5.0),
    ("delay", 1e-2, 1.5, 0.0, 10.0),
    ("force", 1e4, 1.0, 0.05, 10.0),
    ("drag", 1e1, 1.0, 0.01, 50.0),
)


def change(name, unit):
    def of(spec, parameter):
        value, servo = unit * parameter.value[0], spec.actuator("servo")
        if name == "stiffness":
            sysid.apply_pgain(spec, "servo", value)
        elif name == "damping":
            sysid.apply_dgain(spec, "servo", value)
        elif name == "delay":
            servo.delay = value
        elif name == "drag":
            spec.joint("shaft").damping[0] = value
        else:
            servo.forcerange = [-value, value]

    return of


def identify(task):
    spec = mujoco.MjSpec.from_string(SERVO.format(period=task.period_s))
    model = spec.compile()
    data = mujoco.MjData(model)
    start = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
    inputs, outputs = [], []
    for u, y in task.seen:
        t = task.period_s * np.arange(len(u))
        inputs.append(sysid.TimeSeries(t, u.reshape(-1, 1)))
        outputs.append(sysid.TimeSeries.from_names(t[1:], y[1:].reshape(-1, 1), model))
    names = [f"run {k}" for k in range(len(task.seen))]
    sequences = sysid.ModelSequences("servo", spec, names, [start] * len(names), inputs, outputs)
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    parameters = sysid.ParameterDict()
    for name, unit, first, lowest, highest in QUANTITIES[: 5 if task.limited else 3]:
        parameters.add(sysid.Parameter(name, first, lowest, highest, modifier=change(name, unit)))
    found, result = sysid.optimize(parameters, residual, "scipy", verbose=False, max_iters=50, diff_step=1e-3)

    def respond(x, u):
        found.update_from_vector(x)
        for parameter in found.values():
            parameter.apply_modifier(spec)
        fitted = spec.compile()
        state, sensor = rollout.rollout(fitted, mujoco.MjData(fitted), start, u.reshape(-1, 1))
        return np.concatenate([[0.0], sensor[0, :-1, 0]])

    best = np.array(result.x)
    covariance, _ = sysid.calculate_intervals(residual(best, found)[0], result.jac)
    step = np.ones(task.settling)
    slopes = [(respond(best + d, step) - respond(best - d, step)) / 2e-3 for d in 1e-3 * np.eye(len(best))]
    half = QUANTILE_99 * np.sqrt(np.einsum("ik,ij,jk->k", slopes, covariance, slopes))
    value = respond(best, step)
    return Answer(lambda u: respond(best, u), value - half, value + half)
