{{about}}
#
# Needs no package. transfer_functions(ControlSystems) gives objects of ControlSystems.jl.

module {{id}}

const NAME = "{{name}}"
const BOUNDS_HOLD = {{bounds_hold}} # false: the bounds have no level
const LEVEL = {{level}}
const SAMPLE_PERIOD_S = {{period}}
const SAMPLE_PHASE_S = {{phase}}
const FRAME_S = {{frame}}
const OFFSET = {{offset}}

# Text rather than literals: a long matrix literal takes the compiler minutes.
numbers(text) = parse.(Float64, split(text))
matrix(text) = reduce(vcat, [permutedims(numbers(row)) for row in split(strip(text), '\n')])

# theta = [G0, Re G1, Im G1, ...] and its covariance
const THETA = numbers("""
{{theta}}
""")
const COVARIANCE = matrix("""
{{theta_covariance}}
""")

# Step response: answers a unit step at sample 0; bounds for each point and for the whole curve
const STEP = numbers("""
{{step}}
""")
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
const STEP_TIME_S = [SAMPLE_PERIOD_S * m + SAMPLE_PHASE_S for m in 0:length(STEP)-1]
const IMPULSE = diff([0.0; STEP])

# Frequency response of the samples, with bounds for each frequency
const OMEGA_RAD_S = numbers("""
{{omega}}
""")
const RESPONSE = complex.(numbers("""
{{re}}
"""), numbers("""
{{im}}
"""))
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

"Position for a command sampled every SAMPLE_PERIOD_S, without the offset; at rest at `before` until then."
function simulate(command; before=0.0)
    past(k) = k >= 1 ? command[k] : before
    return [sum(IMPULSE[i] * past(k - i + 1) for i in eachindex(IMPULSE)) for k in eachindex(command)]
end

{{low_order}}
end
