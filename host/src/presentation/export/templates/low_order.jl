# Low-order model: K exp(-L s) / denominator(s)
const ORDER = {{order}}
const GAIN = {{gain}}
# What its positions are without. It differs from OFFSET as the gains do: at rest at a command of {{offset_at}} both models have the same position.
const LOW_ORDER_OFFSET = {{low_order_offset}}
const DELAY_S = {{delay}}
const DENOMINATOR = [{{denominator}}] # falling powers of s
const LARGEST_ERROR_PERCENT = {{largest_error}} # {{of_error}}
{{bounds_of_low_order}}
# The same by samples, exactly: x(k+1) = A x(k) + B u(k-m), y(k) = C x(k) + D u(k-m)
const A = matrix("""
{{a}}
""")
const B = [{{b}}]
const C = [{{c}}]
const D = {{d}}
const REST = [{{rest}}] # x at rest at a command of 1
const DELAY_SAMPLES = {{delay_samples}}

"What simulate does, by the low-order model, without LOW_ORDER_OFFSET. A command that is no number leaves none of the later positions."
function simulate_low_order(command; before=0.0)
    x, position = REST * before, zeros(length(command))
    for k in eachindex(position)
        u = k > DELAY_SAMPLES ? command[k-DELAY_SAMPLES] : before
        position[k] = sum(C .* x) + D * u
        x = A * x + B * u
    end
    return position
end

"The low-order transfer function at s (1/s); at s = im * w its frequency response at w rad/s."
low_order(s) = GAIN * exp(-DELAY_S * s) / evalpoly(s, Tuple(reverse(DENOMINATOR)))

"`finite` by samples, and `low_order` continuous with its delay, for the module ControlSystems."
function transfer_functions(ControlSystems)
    finite = ControlSystems.tf(IMPULSE, [1.0; zeros(length(IMPULSE) - 1)], SAMPLE_PERIOD_S)
    continuous = ControlSystems.tf([GAIN], DENOMINATOR) * ControlSystems.delay(DELAY_S)
    return (finite=finite, low_order=continuous)
end

