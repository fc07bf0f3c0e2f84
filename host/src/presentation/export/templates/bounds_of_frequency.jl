# Its bounds for each frequency
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
