# Its standard deviation, and its bounds for each point and for the whole curve
STEP_SD = np.array([
{{sd}}
])
STEP_LOWER = np.array([
{{lower}}
])
STEP_UPPER = np.array([
{{upper}}
])
STEP_LOWER_SIMULTANEOUS = np.array([
{{lower_all}}
])
STEP_UPPER_SIMULTANEOUS = np.array([
{{upper_all}}
])
