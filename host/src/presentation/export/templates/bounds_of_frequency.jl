# Its bounds for each frequency; a lower bound of -300.0 dB says that the magnitude may be zero
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
