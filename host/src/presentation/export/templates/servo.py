"""
{{about}}

Needs numpy. With python-control installed there are also transfer functions of it:
finite_response, measured_frequency_response, and low_order where there is a low-order model.
"""

import numpy as np

try:
    import control
except ImportError:
    control = None

NAME = "{{name}}"
BOUNDS_HOLD = {{bounds_hold}}  # False: there are no bounds below, and no LEVEL
SAMPLE_PERIOD_S = {{period}}
SAMPLE_PHASE_S = {{phase}}
FRAME_S = {{frame}}
OFFSET = {{offset}}

# theta = [G0, Re G1, Im G1, ...]
THETA = np.array([
{{theta}}
])
{{bounds_of_parameters}}
# Step response: answers a unit step at sample 0
STEP_TIME_S = SAMPLE_PERIOD_S * np.arange({{taps}}) + SAMPLE_PHASE_S
STEP = np.array([
{{step}}
])
{{bounds_of_step}}IMPULSE = np.diff(STEP, prepend=0.0)

# Frequency response of the samples, with the hold of the command between two of them
OMEGA_RAD_S = np.array([
{{omega}}
])
RESPONSE = np.array([
{{re}}
]) + 1j * np.array([
{{im}}
])
# The phase of the servo itself, freed of that hold, in degrees: for a continuous loop
SERVO_PHASE_DEG = np.array([
{{servo_phase}}
])
{{bounds_of_frequency}}

def simulate(command, before=0.0):
    """Position for a command sampled every SAMPLE_PERIOD_S, without the offset.

    The servo is at rest at the command `before` until the first sample. A command that is no number
    leaves none of the {{taps}} positions from there on.{{of_response}}
    """
    change = np.asarray(command, dtype=float) - before
    return np.convolve(change, IMPULSE)[: len(change)] + before * STEP[-1]


if control is not None:
    # By samples: z^-1 is one sample period.
    finite_response = control.tf(
        IMPULSE, np.concatenate([[1.0], np.zeros(len(IMPULSE) - 1)]), SAMPLE_PERIOD_S
    )
    measured_frequency_response = control.frd(RESPONSE, OMEGA_RAD_S, SAMPLE_PERIOD_S)

{{low_order}}
