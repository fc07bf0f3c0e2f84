{{about}}
#
# Needs no package. Servo(command) is at rest under a command; its step(command) goes on by STEP_S
# and returns the position.

{{sine}}NAME = "{{name}}"
STEP_S = {{step}}
DELAY_STEPS = {{delay_steps}}  # whole steps
{{parameters}}

HALF_MOTOR = 0.5 * STEP_S * MOTOR_DAMPING


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


# The loop as if the drive had no limit, with `ratio` times its constants.


def braking(ratio):
    """What the loop's damping takes of the speed at each end of a step."""
    return 0.5 * STEP_S * (DAMPING - MOTOR_DAMPING) * ratio


def damped(ratio):
    """The factor by which damping leaves the speed."""
    return 1.0 / (1.0 + HALF_MOTOR + braking(ratio))


def push(error, speed, ratio):
    """Change of speed in a step by the error, and by the speed at its beginning."""
    return error * STEP_S * STIFFNESS * ratio - speed * braking(ratio)


def unlimited_drive(error, speed, loaded, ratio):
    """Change of speed in a step by the drive; `loaded` is the speed after load and the motor's damping."""
    pushed = push(error, speed, ratio)
    return pushed - (loaded + pushed) * damped(ratio) * braking(ratio)


class Servo:
    """The servo: theta, its speed, and the commands that are on their way."""

    def __init__(self, command=0.0):
        """At rest under `command`."""
        self.angle = command
        for _ in range(25):
            self.angle = 0.5 * (self.angle + command - load(self.angle) / STIFFNESS)
        self.speed = 0.0
        self.late = [command] * (DELAY_STEPS + 2)  # a ring
        self.newest = 0

    def position(self):
        """The position now."""
        return GAIN * self.angle + OFFSET

    def step(self, command):
        """The position after STEP_S in which `command` was held."""
        delayed = self.delayed(command)
        middle = self.angle + 0.5 * STEP_S * self.speed
        error = nearer_zero(delayed - middle, DEAD_BAND)
        loaded = self.speed * (1.0 - HALF_MOTOR) - STEP_S * load(middle)

        ratio, largest = 1.0, STEP_S * FULL_DRIVE
        if unlimited_drive(error, self.speed, loaded, 1.0) < 0.0:
            ratio, largest = DOWN_TO_UP, -largest * DOWN_TO_UP
        if abs(unlimited_drive(error, self.speed, loaded, ratio)) > abs(largest):
            pushed, left = largest, 1.0 / (1.0 + HALF_MOTOR)
        else:
            pushed, left = push(error, self.speed, ratio), damped(ratio)

        relative = self.speed / FRICTION_SPEED
        held = FRICTION * (1.0 + FRICTION_AT_REST / (1.0 + relative * relative))
        self.speed = nearer_zero((loaded + pushed) * left, STEP_S * left * held)
        self.angle = middle + 0.5 * STEP_S * self.speed
        return self.position()

    def delayed(self, command):
        """The mean of the delayed command over a step that begins with `command`."""
        count = len(self.late)
        self.late[self.newest] = command
        self.newest = (self.newest + 1) % count
        older, newer = self.late[self.newest], self.late[(self.newest + 1) % count]
        return DELAY_FRACTION * older + (1.0 - DELAY_FRACTION) * newer


def simulate(command):
    """The positions at the ends of steps with these commands, from rest under the first of them."""
    command = list(command)
    servo = Servo(command[0]) if command else None
    return [servo.step(value) for value in command]
