# Bounds of the response of the samples for each frequency; a lower bound of -300.0 dB says that the magnitude may be zero
MAGNITUDE_DB_LOWER = np.array([
{{magnitude_lower}}
])
MAGNITUDE_DB_UPPER = np.array([
{{magnitude_upper}}
])
PHASE_DEG_LOWER = np.array([
{{phase_lower}}
])
PHASE_DEG_UPPER = np.array([
{{phase_upper}}
])
# Those of the phase of the servo itself
SERVO_PHASE_DEG_LOWER = np.array([
{{servo_phase_lower}}
])
SERVO_PHASE_DEG_UPPER = np.array([
{{servo_phase_upper}}
])
