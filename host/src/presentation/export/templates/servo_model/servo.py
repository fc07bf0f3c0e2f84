"""
{{about}}

Needs no package. Servo(command) is at rest under a command; its step(command) goes on by STEP_S
and returns the position.
"""

{{sine}}NAME = "{{name}}"
STEP_S = {{step}}
DELAY_STEPS = {{delay_steps}}  # whole steps
{{parameters}}


def load(angle):
    """Acceleration that the load takes at an angle."""
    return {{load}}


def nearer_zero(value, width):
    """`value` moved towards zero by `width`, and zero where it would pass it."""
    if value > width:
        return value - width
    if value < -width:
        return value + width
    return 0.0


def friction_at(speed, held):
    """What friction takes at a speed, where it takes `held` at high ones."""
    relative = speed / FRICTION_SPEED
    return held * (1.0 + FRICTION_AT_REST / (1.0 + relative * relative))


def released(wanted, held):
    """The speed after a step from rest, where it would be `wanted` without friction."""
    slow = nearer_zero(wanted, friction_at(0.0, held))
    if slow == 0.0:
        return slow
    taken = friction_at(0.5 * slow, held)
    return wanted - taken if slow > 0.0 else wanted + taken


def braked(speed, wanted, held):
    """The speed after a step, where it would be `wanted` without friction.

    Friction is that in the middle of the step; a shaft that comes to rest within the step is held or turns round for what is left of it.
    """
    if speed == 0.0:
        return released(wanted, held)
    sign = 1.0 if speed > 0.0 else -1.0
    slowed = wanted - sign * friction_at(speed, held)
    middle = 0.5 * (speed + slowed) if sign * slowed > 0.0 else 0.5 * speed
    after = wanted - sign * friction_at(middle, held)
    if sign * after >= 0.0:
        return after
    return released(wanted - speed, held) * (after / (after - speed))


def between_stops(angle):
    """The angle, no farther than the stops."""
    return max(LOWEST_ANGLE, min(HIGHEST_ANGLE, angle))


# The loop as if the drive had no limit, with `ratio` times its constants, over h seconds.


def half_motor(h):
    """Half of what the motor's damping takes of the speed."""
    return 0.5 * h * MOTOR_DAMPING


def braking(h, ratio):
    """What the loop's damping takes of the speed at each end."""
    return 0.5 * h * (DAMPING - MOTOR_DAMPING) * ratio


def damped(h, ratio):
    """The factor by which damping leaves the speed."""
    return 1.0 / (1.0 + half_motor(h) + braking(h, ratio))


def push(h, error, speed, ratio):
    """Change of speed by the error, and by the speed at the beginning."""
    return error * h * STIFFNESS * ratio - speed * braking(h, ratio)


def unlimited_drive(h, error, speed, loaded, ratio):
    """Change of speed by the drive; `loaded` is the speed after load and the motor's damping."""
    pushed = push(h, error, speed, ratio)
    return pushed - (loaded + pushed) * damped(h, ratio) * braking(h, ratio)


# Rest: the shaft stays at all angles at which the drive differs from the load by no more than friction
# holds. It rests in the middle of them; `end` is -1 for the upper end of them and 1 for the lower.


def sign(value):
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)


def side_of(drive, ratio):
    """`ratio` where a drive of this sign is negative."""
    return ratio if drive < 0.0 else 1.0


def held_by(angle, end):
    """The drive that just holds the shaft at an end."""
    more = end * (1.0 + FRICTION_AT_REST)
    own, share = more * FRICTION, more * FRICTION_OF_GEARS
    if abs(share) >= 1.0:
        return load(angle)  # friction that holds any drive counts as none
    if 2.0 * load(angle) + own < 0.0:
        share = -share
    return (load(angle) * (1.0 + share) + own) / (1.0 - share)


def error_of(drive):
    """The error at rest under which a drive without limit is `drive`."""
    return drive / (STIFFNESS * side_of(drive, LOOP_DOWN_TO_UP)) + sign(drive) * DEAD_BAND


def excess(command, angle, end):
    """By how much the drive at rest is more than the one that holds the shaft."""
    seen = nearer_zero(command - angle, DEAD_BAND)
    largest = FULL_DRIVE * side_of(seen, DOWN_TO_UP)
    drive = STIFFNESS * side_of(seen, LOOP_DOWN_TO_UP) * seen
    return max(-largest, min(largest, drive)) - held_by(angle, end)


def end_of_rest(command, end):
    """The angle of an end: where the shaft comes to from the command, slowly. A load that full drive does
    not hold has no rest: then that of a drive without limit."""
    error = error_of(held_by(command, end))
    side, near, far = -sign(error), 0.0, abs(error)

    def pulled(distance):
        return side * excess(command, command + side * distance, end) > 0.0

    for _ in range(8):
        if pulled(far):
            near, far = far, 2.0 * far
    if pulled(far):
        return command - error
    for _ in range(60):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if pulled(middle) else (near, middle)
    return command + side * far


class Servo:
    """The servo: theta, its speed, and the commands that are on their way."""

    def __init__(self, command=0.0):
        """At rest under `command`, which must be a number."""
        command = float(command)  # a number of numpy is slower, and may have fewer digits
        ends = end_of_rest(command, -1.0), end_of_rest(command, 1.0)
        self.angle = 0.5 * (between_stops(ends[0]) + between_stops(ends[1]))
        self.speed = 0.0
        self.shown = self.angle  # phi, the angle that the position shows: in the middle of the play
        self.late = [command] * (DELAY_STEPS + 2)  # a ring
        self.newest = 0

    def position(self):
        """The position now."""
        return GAIN * self.shown + OFFSET

    def step(self, command):
        """The position after STEP_S in which `command` was held.

        A command that is no number, or beyond 1e30, counts as the last one that is.
        """
        count = len(self.late)
        self.late[self.newest] = float(command) if abs(command) < 1e30 else self.late[self.newest - 1]
        self.newest = (self.newest + 1) % count
        older, newer = self.late[self.newest], self.late[(self.newest + 1) % count]
        # The delayed command changes within the step: the motion is computed to there, and from there.
        if older == newer:
            self.advance(STEP_S, newer)
        else:
            self.advance(DELAY_FRACTION * STEP_S, older)
            self.advance((1.0 - DELAY_FRACTION) * STEP_S, newer)
        return self.position()

    def advance(self, h, command):
        """The motion of h seconds under a command, without delay."""
        middle = self.angle + 0.5 * h * self.speed
        error = nearer_zero(command - middle, DEAD_BAND)
        loading = h * load(middle)
        loaded = self.speed * (1.0 - half_motor(h)) - loading

        ratio, largest = 1.0, h * FULL_DRIVE
        if unlimited_drive(h, error, self.speed, loaded, 1.0) < 0.0:
            ratio, largest = LOOP_DOWN_TO_UP, -largest * DOWN_TO_UP
        drive = unlimited_drive(h, error, self.speed, loaded, ratio)
        if abs(drive) > abs(largest):
            drive = pushed = largest
            left = 1.0 / (1.0 + half_motor(h))
        else:
            pushed, left = push(h, error, self.speed, ratio), damped(h, ratio)

        held = h * FRICTION + FRICTION_OF_GEARS * abs(drive + loading)
        before, wanted = self.speed, braked(self.speed, (loaded + pushed) * left, left * held)
        self.speed = max(LOWEST_SPEED, min(HIGHEST_SPEED, wanted))
        self.angle = middle + 0.5 * h * self.speed
        # The speed stays at its limit for the rest of the step.
        if self.speed not in (wanted, before):
            share = (wanted - self.speed) / (wanted - before)
            self.angle += 0.5 * h * (self.speed - before) * share
        # A stop takes all speed.
        if self.angle != between_stops(self.angle):
            self.angle, self.speed = between_stops(self.angle), 0.0
        # Behind its play the position is taken along.
        self.shown = max(self.angle - 0.5 * PLAY, min(self.angle + 0.5 * PLAY, self.shown))


def simulate(command):
    """The positions at the ends of steps of {{step}} s with these commands, one for each, from rest under the first of them."""
    command = list(command)
    servo = Servo(command[0]) if command else None
    return [servo.step(value) for value in command]
