{{about}}
#
# Needs no package. Servo(command) is at rest under a command; step!(servo, command) goes on by
# STEP_S and returns the position.

module {{id}}

const NAME = "{{name}}"
const STEP_S = {{step}}
const DELAY_STEPS = {{delay_steps}} # whole steps
{{parameters}}

const HALF_MOTOR = 0.5 * STEP_S * MOTOR_DAMPING

"Acceleration that the load takes at an angle."
load(angle) = {{load}}

"`value` moved towards zero by `width`, and zero where it would pass it."
nearer_zero(value, width) = value > width ? value - width : (value < -width ? value + width : 0.0)

# The loop as if the drive had no limit, with `ratio` times its constants.

"What the loop's damping takes of the speed at each end of a step."
braking(ratio) = 0.5 * STEP_S * (DAMPING - MOTOR_DAMPING) * ratio

"The factor by which damping leaves the speed."
damped(ratio) = 1.0 / (1.0 + HALF_MOTOR + braking(ratio))

"Change of speed in a step by the error, and by the speed at its beginning."
push(error, speed, ratio) = error * STEP_S * STIFFNESS * ratio - speed * braking(ratio)

"Change of speed in a step by the drive; `loaded` is the speed after load and the motor's damping."
function unlimited_drive(error, speed, loaded, ratio)
    pushed = push(error, speed, ratio)
    return pushed - (loaded + pushed) * damped(ratio) * braking(ratio)
end

"The servo: theta, its speed, and the commands that are on their way."
mutable struct Servo
    angle::Float64
    speed::Float64
    late::Vector{Float64} # a ring
    newest::Int # from 0
end

"At rest under `command`."
function Servo(command::Real=0.0)
    angle = Float64(command)
    for _ in 1:25
        angle = 0.5 * (angle + command - load(angle) / STIFFNESS)
    end
    return Servo(angle, 0.0, fill(Float64(command), DELAY_STEPS + 2), 0)
end

"The position now."
position(servo::Servo) = GAIN * servo.angle + OFFSET

"The mean of the delayed command over a step that begins with `command`."
function delayed!(servo::Servo, command)
    count = length(servo.late)
    servo.late[servo.newest+1] = command
    servo.newest = (servo.newest + 1) % count
    older, newer = servo.late[servo.newest+1], servo.late[(servo.newest+1)%count+1]
    return DELAY_FRACTION * older + (1.0 - DELAY_FRACTION) * newer
end

"The position after STEP_S in which `command` was held."
function step!(servo::Servo, command)
    delayed = delayed!(servo, command)
    middle = servo.angle + 0.5 * STEP_S * servo.speed
    error = nearer_zero(delayed - middle, DEAD_BAND)
    loaded = servo.speed * (1.0 - HALF_MOTOR) - STEP_S * load(middle)

    ratio, largest = 1.0, STEP_S * FULL_DRIVE
    if unlimited_drive(error, servo.speed, loaded, 1.0) < 0.0
        ratio, largest = DOWN_TO_UP, -largest * DOWN_TO_UP
    end
    if abs(unlimited_drive(error, servo.speed, loaded, ratio)) > abs(largest)
        pushed, left = largest, 1.0 / (1.0 + HALF_MOTOR)
    else
        pushed, left = push(error, servo.speed, ratio), damped(ratio)
    end

    relative = servo.speed / FRICTION_SPEED
    held = FRICTION * (1.0 + FRICTION_AT_REST / (1.0 + relative * relative))
    servo.speed = nearer_zero((loaded + pushed) * left, STEP_S * left * held)
    servo.angle = middle + 0.5 * STEP_S * servo.speed
    return position(servo)
end

"The positions at the ends of steps with these commands, from rest under the first of them."
function simulate(command)
    isempty(command) && return Float64[]
    servo = Servo(first(command))
    return [step!(servo, value) for value in command]
end

end
