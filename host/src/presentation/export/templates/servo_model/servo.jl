{{about}}
#
# Needs no package. Servo(command) is at rest under a command; step!(servo, command) goes on by
# STEP_S and returns the position.

module {{id}}

const NAME = "{{name}}"
const STEP_S = {{step}}
const DELAY_STEPS = {{delay_steps}} # whole steps
{{parameters}}

"Acceleration that the load takes at an angle."
load(angle) = {{load}}

"`value` moved towards zero by `width`, and zero where it would pass it."
nearer_zero(value, width) = value > width ? value - width : (value < -width ? value + width : 0.0)

"What friction takes at a speed, where it takes `held` at high ones."
friction_at(speed, held) = held * (1.0 + FRICTION_AT_REST / (1.0 + (speed / FRICTION_SPEED)^2))

"The speed after a step from rest, where it would be `wanted` without friction."
function released(wanted, held)
    slow = nearer_zero(wanted, friction_at(0.0, held))
    return slow == 0.0 ? slow : wanted - sign(slow) * friction_at(0.5 * slow, held)
end

"The speed after a step, where it would be `wanted` without friction. Friction is that in the middle of the step; a shaft that comes
to rest within the step is held or turns round for what is left of it."
function braked(speed, wanted, held)
    speed == 0.0 && return released(wanted, held)
    slowed = wanted - sign(speed) * friction_at(speed, held)
    middle = sign(speed) * slowed > 0.0 ? 0.5 * (speed + slowed) : 0.5 * speed
    after = wanted - sign(speed) * friction_at(middle, held)
    sign(speed) * after >= 0.0 && return after
    return released(wanted - speed, held) * (after / (after - speed))
end

"The angle, no farther than the stops."
between_stops(angle) = clamp(angle, LOWEST_ANGLE, HIGHEST_ANGLE)

# The loop as if the drive had no limit, with `ratio` times its constants, over h seconds.

"Half of what the motor's damping takes of the speed."
half_motor(h) = 0.5 * h * MOTOR_DAMPING

"What the loop's damping takes of the speed at each end."
braking(h, ratio) = 0.5 * h * (DAMPING - MOTOR_DAMPING) * ratio

"The factor by which damping leaves the speed."
damped(h, ratio) = 1.0 / (1.0 + half_motor(h) + braking(h, ratio))

"Change of speed by the error, and by the speed at the beginning."
push(h, error, speed, ratio) = error * h * STIFFNESS * ratio - speed * braking(h, ratio)

"Change of speed by the drive; `loaded` is the speed after load and the motor's damping."
function unlimited_drive(h, error, speed, loaded, ratio)
    pushed = push(h, error, speed, ratio)
    return pushed - (loaded + pushed) * damped(h, ratio) * braking(h, ratio)
end

# Rest: the shaft stays at all angles at which the drive differs from the load by no more than friction
# holds. It rests in the middle of them; `last` is -1 for the upper end of them and 1 for the lower.

"`ratio` where a drive of this sign is negative."
side_of(drive, ratio) = drive < 0.0 ? ratio : 1.0

"The drive that just holds the shaft at an end."
function held_by(angle, last)
    more = last * (1.0 + FRICTION_AT_REST)
    own, share = more * FRICTION, more * FRICTION_OF_GEARS
    abs(share) >= 1.0 && return load(angle) # friction that holds any drive counts as none
    share = 2.0 * load(angle) + own < 0.0 ? -share : share
    return (load(angle) * (1.0 + share) + own) / (1.0 - share)
end

"The error at rest under which a drive without limit is `drive`."
error_of(drive) = drive / (STIFFNESS * side_of(drive, LOOP_DOWN_TO_UP)) + sign(drive) * DEAD_BAND

"By how much the drive at rest is more than the one that holds the shaft."
function excess(command, angle, last)
    seen = nearer_zero(command - angle, DEAD_BAND)
    largest = FULL_DRIVE * side_of(seen, DOWN_TO_UP)
    return clamp(STIFFNESS * side_of(seen, LOOP_DOWN_TO_UP) * seen, -largest, largest) - held_by(angle, last)
end

"The angle of an end: where the shaft comes to from the command, slowly. A load that full drive does not
hold has no rest: then that of a drive without limit."
function end_of_rest(command, last)
    off = error_of(held_by(command, last))
    side, near, far = -sign(off), 0.0, abs(off)
    pulled(distance) = side * excess(command, command + side * distance, last) > 0.0
    for _ in 1:8
        if pulled(far)
            near, far = far, 2.0 * far
        end
    end
    pulled(far) && return command - off
    for _ in 1:60
        middle = 0.5 * (near + far)
        near, far = pulled(middle) ? (middle, far) : (near, middle)
    end
    return command + side * far
end

"The servo: theta, its speed, and the commands that are on their way."
mutable struct Servo
    angle::Float64
    speed::Float64
    shown::Float64 # phi, the angle that the position shows
    late::Vector{Float64} # a ring
    newest::Int # from 0
end

"At rest under `command`, which must be a number."
function Servo(command::Real=0.0)
    ends = end_of_rest(Float64(command), -1.0), end_of_rest(Float64(command), 1.0)
    angle = 0.5 * (between_stops(ends[1]) + between_stops(ends[2]))
    return Servo(angle, 0.0, angle, fill(Float64(command), DELAY_STEPS + 2), 0)
end

"The position now."
position(servo::Servo) = GAIN * servo.shown + OFFSET

"The position after STEP_S in which `command` was held. One that is no number, or beyond 1e30, counts as the last one that is."
function step!(servo::Servo, command)
    count = length(servo.late)
    servo.late[servo.newest+1] = abs(command) < 1e30 ? command : servo.late[mod(servo.newest - 1, count)+1]
    servo.newest = (servo.newest + 1) % count
    older, newer = servo.late[servo.newest+1], servo.late[(servo.newest+1)%count+1]
    # The delayed command changes within the step: the motion is computed to there, and from there.
    if older == newer
        advance!(servo, STEP_S, newer)
    else
        advance!(servo, DELAY_FRACTION * STEP_S, older)
        advance!(servo, (1.0 - DELAY_FRACTION) * STEP_S, newer)
    end
    return position(servo)
end

"The motion of h seconds under a command, without delay."
function advance!(servo::Servo, h, command)
    middle = servo.angle + 0.5 * h * servo.speed
    error = nearer_zero(command - middle, DEAD_BAND)
    loading = h * load(middle)
    loaded = servo.speed * (1.0 - half_motor(h)) - loading

    ratio, largest = 1.0, h * FULL_DRIVE
    if unlimited_drive(h, error, servo.speed, loaded, 1.0) < 0.0
        ratio, largest = LOOP_DOWN_TO_UP, -largest * DOWN_TO_UP
    end
    drive = unlimited_drive(h, error, servo.speed, loaded, ratio)
    if abs(drive) > abs(largest)
        drive = pushed = largest
        left = 1.0 / (1.0 + half_motor(h))
    else
        pushed, left = push(h, error, servo.speed, ratio), damped(h, ratio)
    end

    held = h * FRICTION + FRICTION_OF_GEARS * abs(drive + loading)
    before, wanted = servo.speed, braked(servo.speed, (loaded + pushed) * left, left * held)
    servo.speed = clamp(wanted, LOWEST_SPEED, HIGHEST_SPEED)
    servo.angle = middle + 0.5 * h * servo.speed
    # The speed stays at its limit for the rest of the step.
    if servo.speed != wanted && servo.speed != before
        share = (wanted - servo.speed) / (wanted - before)
        servo.angle += 0.5 * h * (servo.speed - before) * share
    end
    # A stop takes all speed.
    if servo.angle != between_stops(servo.angle)
        servo.angle, servo.speed = between_stops(servo.angle), 0.0
    end
    # Behind its play the position is taken along.
    servo.shown = clamp(servo.shown, servo.angle - 0.5 * PLAY, servo.angle + 0.5 * PLAY)
    return servo
end

"The positions at the ends of steps of {{step}} s with these commands, one for each, from rest under the first of them."
function simulate(command)
    isempty(command) && return Float64[]
    servo = Servo(first(command))
    return [step!(servo, value) for value in command]
end

end
