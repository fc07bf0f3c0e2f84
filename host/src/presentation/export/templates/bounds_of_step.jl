# Its standard deviation, and its bounds for each point and for the whole curve
const STEP_SD = numbers("""
{{sd}}
""")
const STEP_LOWER = numbers("""
{{lower}}
""")
const STEP_UPPER = numbers("""
{{upper}}
""")
const STEP_LOWER_SIMULTANEOUS = numbers("""
{{lower_all}}
""")
const STEP_UPPER_SIMULTANEOUS = numbers("""
{{upper_all}}
""")
