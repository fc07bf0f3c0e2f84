# Low-order model: K exp(-L s) / denominator(s)
ORDER = {{order}}
GAIN = {{gain}}
# What its positions are without. It differs from OFFSET as the gains do: at rest at a command of {{offset_at}} both models have the same position.
LOW_ORDER_OFFSET = {{low_order_offset}}
DELAY_S = {{delay}}
DENOMINATOR = [{{denominator}}]  # falling powers of s
LARGEST_ERROR_PERCENT = {{largest_error}}  # {{of_error}}
{{bounds_of_low_order}}
# The same by samples, exactly: x(k+1) = A x(k) + B u(k-m), y(k) = C x(k) + D u(k-m)
A = np.array([
{{a}}
])
B = np.array([{{b}}])
C = np.array([{{c}}])
D = {{d}}
REST = np.array([{{rest}}])  # x at rest at a command of 1
DELAY_SAMPLES = {{delay_samples}}


def simulate_low_order(command, before=0.0):
    """What simulate() does, by the low-order model, without LOW_ORDER_OFFSET. A command that is no number leaves none of the later positions."""
    command = np.asarray(command, dtype=float)
    late = np.concatenate([np.full(DELAY_SAMPLES, before), command])[: len(command)]
    x, position = REST * before, np.empty(len(command))
    for k, u in enumerate(late):
        position[k] = C @ x + D * u
        x = A @ x + B * u
    return position


if control is not None:
    # Continuous and without its delay of DELAY_S, which is no ratio of polynomials.
    low_order_without_delay = control.tf([GAIN], DENOMINATOR)
    # By samples, delay included.
    low_order = control.ss(
        A, B.reshape(-1, 1), C.reshape(1, -1), [[D]], SAMPLE_PERIOD_S
    ) * control.tf(
        [1.0], np.concatenate([[1.0], np.zeros(DELAY_SAMPLES)]), SAMPLE_PERIOD_S
    )
