{{about}}
#
# Needs no package. transfer_functions(ControlSystems) gives objects of ControlSystems.jl.

module {{id}}

const NAME = "{{name}}"
const BOUNDS_HOLD = {{bounds_hold}} # false: there are no bounds below, and no LEVEL
const SAMPLE_PERIOD_S = {{period}}
const SAMPLE_PHASE_S = {{phase}}
const FRAME_S = {{frame}}
const OFFSET = {{offset}}

# Text rather than literals: a long matrix literal takes the compiler minutes.
numbers(text) = parse.(Float64, split(text))
matrix(text) = reduce(vcat, [permutedims(numbers(row)) for row in split(strip(text), '\n')])

# theta = [G0, Re G1, Im G1, ...]
const THETA = numbers("""
{{theta}}
""")
{{bounds_of_parameters}}
# Step response: answers a unit step at sample 0
const STEP = numbers("""
{{step}}
""")
{{bounds_of_step}}const STEP_TIME_S = [SAMPLE_PERIOD_S * m + SAMPLE_PHASE_S for m in 0:length(STEP)-1]
const IMPULSE = diff([0.0; STEP])

# Frequency response of the samples, with the hold of the command between two of them
const OMEGA_RAD_S = numbers("""
{{omega}}
""")
const RESPONSE = complex.(numbers("""
{{re}}
"""), numbers("""
{{im}}
"""))
# The phase of the servo itself, freed of that hold, in degrees: for a continuous loop
const SERVO_PHASE_DEG = numbers("""
{{servo_phase}}
""")
{{bounds_of_frequency}}
"Position for a command sampled every SAMPLE_PERIOD_S, without the offset; at rest at `before` until then. A command that is no number leaves none of the {{taps}} positions from there on.{{of_response}}"
function simulate(command; before=0.0)
    past(k) = k >= 1 ? command[k] : before
    return [sum(IMPULSE[i] * past(k - i + 1) for i in eachindex(IMPULSE)) for k in eachindex(command)]
end

{{low_order}}
end
