# Bounds of the response of the samples for each frequency; a lower bound of -300.0 dB says that the magnitude may be zero
const MAGNITUDE_DB_LOWER = numbers("""
{{magnitude_lower}}
""")
const MAGNITUDE_DB_UPPER = numbers("""
{{magnitude_upper}}
""")
const PHASE_DEG_LOWER = numbers("""
{{phase_lower}}
""")
const PHASE_DEG_UPPER = numbers("""
{{phase_upper}}
""")
# Those of the phase of the servo itself
const SERVO_PHASE_DEG_LOWER = numbers("""
{{servo_phase_lower}}
""")
const SERVO_PHASE_DEG_UPPER = numbers("""
{{servo_phase_upper}}
""")
