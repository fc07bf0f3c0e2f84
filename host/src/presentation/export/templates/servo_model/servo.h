/*
{{about}}
 *
 * C99, no allocation. {{id}}_real is float unless {{ID}}_REAL says otherwise, for example
 * -D{{ID}}_REAL=double.
 */
#ifndef {{ID}}_SERVO_MODEL_H
#define {{ID}}_SERVO_MODEL_H

/* Constants have all their digits, which a float rounds. */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#endif

{{sine}}#ifndef {{ID}}_REAL
#define {{ID}}_REAL float
#endif
#ifndef {{ID}}_NAME /* the linear model of this servo has both, too */
#define {{ID}}_NAME "{{name}}"
typedef {{ID}}_REAL {{id}}_real;
#endif

#define {{ID}}_STEP_S {{step}}
#define {{ID}}_DELAY_STEPS {{delay_steps}} /* whole steps */
#define {{ID}}_LATE ({{ID}}_DELAY_STEPS + 2) /* commands that are on their way */

/* Times are counted with this: single precision would be off by a step after minutes. */
static const double {{id}}_step_s = {{ID}}_STEP_S;
{{parameters}}

typedef struct {
    {{id}}_real angle; /* theta */
    {{id}}_real speed;
    {{id}}_real shown; /* phi, the angle that the position shows */
    {{id}}_real late[{{ID}}_LATE]; /* a ring */
    unsigned newest;
} {{id}}_state;

/* Acceleration that the load takes at an angle. */
static inline {{id}}_real {{id}}_load({{id}}_real angle)
{
    (void)angle; /* for a load that is the same everywhere */
    return {{load}};
}

/* `value` moved towards zero by `width`, and zero where it would pass it. */
static inline {{id}}_real {{id}}_nearer_zero({{id}}_real value, {{id}}_real width)
{
    return value > width ? value - width : (value < -width ? value + width : 0);
}

static inline {{id}}_real {{id}}_size({{id}}_real value)
{
    return value < 0 ? -value : value;
}

/* The loop as if the drive had no limit, with `ratio` times its constants, over h seconds. */

/* Half of what the motor's damping takes of the speed. */
static inline {{id}}_real {{id}}_half_motor({{id}}_real h)
{
    return h * {{id}}_motor_damping / 2;
}

/* What the loop's damping takes of the speed at each end. */
static inline {{id}}_real {{id}}_braking({{id}}_real h, {{id}}_real ratio)
{
    return h * ({{id}}_damping - {{id}}_motor_damping) * ratio / 2;
}

/* The factor by which damping leaves the speed. */
static inline {{id}}_real {{id}}_damped({{id}}_real h, {{id}}_real ratio)
{
    return 1 / (1 + {{id}}_half_motor(h) + {{id}}_braking(h, ratio));
}

/* Change of speed by the error, and by the speed at the beginning. */
static inline {{id}}_real {{id}}_push(
    {{id}}_real h, {{id}}_real error, {{id}}_real speed, {{id}}_real ratio)
{
    return error * h * {{id}}_stiffness * ratio - speed * {{id}}_braking(h, ratio);
}

/* Change of speed by the drive; `loaded` is the speed after load and the motor's damping. */
static inline {{id}}_real {{id}}_unlimited_drive(
    {{id}}_real h, {{id}}_real error, {{id}}_real speed, {{id}}_real loaded, {{id}}_real ratio)
{
    {{id}}_real pushed = {{id}}_push(h, error, speed, ratio);
    return pushed - (loaded + pushed) * {{id}}_damped(h, ratio) * {{id}}_braking(h, ratio);
}

/* The position now. */
static inline {{id}}_real {{id}}_position(const {{id}}_state *servo)
{
    return {{id}}_gain * servo->shown + {{id}}_offset;
}

/* Rest: the shaft stays at all angles at which the drive differs from the load by no more than friction
 * holds. It rests in the middle of them; `end` is -1 for the upper end of them and 1 for the lower. */

static inline {{id}}_real {{id}}_sign({{id}}_real value)
{
    return value < 0 ? -1 : (value > 0 ? 1 : 0);
}

/* `ratio` where a drive of this sign is negative. */
static inline {{id}}_real {{id}}_side({{id}}_real drive, {{id}}_real ratio)
{
    return drive < 0 ? ratio : 1;
}

/* The drive that just holds the shaft at an end. */
static inline {{id}}_real {{id}}_held({{id}}_real angle, {{id}}_real end)
{
    {{id}}_real load = {{id}}_load(angle), more = 1 + {{id}}_friction_at_rest;
    {{id}}_real own = end * more * {{id}}_friction, share = end * more * {{id}}_friction_of_gears;
    if ({{id}}_size(share) >= 1) {
        return load; /* friction that holds any drive counts as none */
    }
    share *= 2 * load + own < 0 ? -1 : 1;
    return (load * (1 + share) + own) / (1 - share);
}

/* The error at rest under which a drive without limit is `drive`. */
static inline {{id}}_real {{id}}_error_of({{id}}_real drive)
{
    return drive / ({{id}}_stiffness * {{id}}_side(drive, {{id}}_loop_down_to_up)) + {{id}}_sign(drive) * {{id}}_dead_band;
}

/* By how much the drive at rest is more than the one that holds the shaft. */
static inline {{id}}_real {{id}}_excess({{id}}_real command, {{id}}_real angle, {{id}}_real end)
{
    {{id}}_real seen = {{id}}_nearer_zero(command - angle, {{id}}_dead_band);
    {{id}}_real largest = {{id}}_full_drive * {{id}}_side(seen, {{id}}_down_to_up);
    {{id}}_real drive = {{id}}_stiffness * {{id}}_side(seen, {{id}}_loop_down_to_up) * seen;
    if ({{id}}_size(drive) > largest) {
        drive = {{id}}_sign(seen) * largest;
    }
    return drive - {{id}}_held(angle, end);
}

/* The angle of an end: where the shaft comes to from the command, slowly. A load that full drive does not
 * hold has no rest: then that of a drive without limit. */
static inline {{id}}_real {{id}}_end({{id}}_real command, {{id}}_real end)
{
    {{id}}_real error = {{id}}_error_of({{id}}_held(command, end));
    {{id}}_real side = -{{id}}_sign(error), near = 0, far = {{id}}_size(error);
    for (unsigned i = 0; i < 8 && side * {{id}}_excess(command, command + side * far, end) > 0; i++) {
        near = far;
        far = 2 * far;
    }
    if (side * {{id}}_excess(command, command + side * far, end) > 0) {
        return command - error;
    }
    for (unsigned i = 0; i < 60; i++) {
        {{id}}_real middle = (near + far) / 2;
        if (side * {{id}}_excess(command, command + side * middle, end) > 0) {
            near = middle;
        } else {
            far = middle;
        }
    }
    return command + side * far;
}

/* The angle, no farther than the stops. */
static inline {{id}}_real {{id}}_between_stops({{id}}_real angle)
{
    if (angle < {{id}}_lowest_angle) {
        return {{id}}_lowest_angle;
    }
    return angle > {{id}}_highest_angle ? {{id}}_highest_angle : angle;
}

/* At rest under this command, which must be a number. */
static inline void {{id}}_reset({{id}}_state *servo, {{id}}_real command)
{
    {{id}}_real upper = {{id}}_end(command, -1), lower = {{id}}_end(command, 1);
    servo->angle = ({{id}}_between_stops(upper) + {{id}}_between_stops(lower)) / 2;
    servo->speed = 0;
    servo->shown = servo->angle; /* in the middle of the play */
    for (unsigned i = 0; i < {{ID}}_LATE; i++) {
        servo->late[i] = command;
    }
    servo->newest = 0;
}

/* What friction takes at a speed, where it takes this at high ones. */
static inline {{id}}_real {{id}}_friction_at({{id}}_real speed, {{id}}_real held)
{
    {{id}}_real relative = speed / {{id}}_friction_speed;
    return held * (1 + {{id}}_friction_at_rest / (1 + relative * relative));
}

/* The speed after a step from rest, where it would be this without friction. */
static inline {{id}}_real {{id}}_released({{id}}_real wanted, {{id}}_real held)
{
    {{id}}_real slow = {{id}}_nearer_zero(wanted, {{id}}_friction_at(0, held));
    if (slow > 0) {
        return wanted - {{id}}_friction_at(slow / 2, held);
    }
    return slow < 0 ? wanted + {{id}}_friction_at(slow / 2, held) : 0;
}

/* The speed after a step, where it would be the wanted one without friction. Friction is that in the middle of
 * the step; a shaft that comes to rest within the step is held or turns round for what is left of it. */
static inline {{id}}_real {{id}}_braked({{id}}_real speed, {{id}}_real wanted, {{id}}_real held)
{
    if (!(speed < 0 || speed > 0)) {
        return {{id}}_released(wanted, held);
    }
    {{id}}_real sign = speed < 0 ? -1 : 1;
    {{id}}_real slowed = wanted - sign * {{id}}_friction_at(speed, held);
    {{id}}_real middle = sign * slowed > 0 ? (speed + slowed) / 2 : speed / 2;
    {{id}}_real after = wanted - sign * {{id}}_friction_at(middle, held);
    if (sign * after >= 0) {
        return after;
    }
    return {{id}}_released(wanted - speed, held) * (after / (after - speed));
}

/* The motion of h seconds under a command, without delay. */
static inline void {{id}}_advance({{id}}_state *servo, {{id}}_real h, {{id}}_real command)
{
    {{id}}_real speed = servo->speed, middle = servo->angle + h * speed / 2;
    {{id}}_real error = {{id}}_nearer_zero(command - middle, {{id}}_dead_band);
    {{id}}_real load = h * {{id}}_load(middle);
    {{id}}_real loaded = speed * (1 - {{id}}_half_motor(h)) - load;

    {{id}}_real ratio = 1, largest = h * {{id}}_full_drive;
    if ({{id}}_unlimited_drive(h, error, speed, loaded, 1) < 0) {
        ratio = {{id}}_loop_down_to_up;
        largest = -largest * {{id}}_down_to_up;
    }
    {{id}}_real pushed = {{id}}_push(h, error, speed, ratio), left = {{id}}_damped(h, ratio);
    {{id}}_real drive = {{id}}_unlimited_drive(h, error, speed, loaded, ratio);
    if ({{id}}_size(drive) > {{id}}_size(largest)) {
        drive = pushed = largest;
        left = 1 / (1 + {{id}}_half_motor(h));
    }

    {{id}}_real held = h * {{id}}_friction + {{id}}_friction_of_gears * {{id}}_size(drive + load);
    {{id}}_real wanted = {{id}}_braked(speed, (loaded + pushed) * left, left * held);
    {{id}}_real limit = wanted < {{id}}_lowest_speed ? {{id}}_lowest_speed : wanted;
    limit = limit > {{id}}_highest_speed ? {{id}}_highest_speed : limit;
    servo->speed = limit;
    servo->angle = middle + h * servo->speed / 2;
    /* The speed stays at its limit for the rest of the step. */
    if ((limit < wanted || limit > wanted) && (limit < speed || limit > speed)) {
        servo->angle += h / 2 * (limit - speed) * ((wanted - limit) / (wanted - speed));
    }
    /* A stop takes all speed. */
    {{id}}_real free = servo->angle;
    servo->angle = {{id}}_between_stops(free);
    if (free < servo->angle || free > servo->angle) {
        servo->speed = 0;
    }
    /* Behind its play the position is taken along. */
    {{id}}_real least = servo->angle - {{id}}_play / 2, most = servo->angle + {{id}}_play / 2;
    {{id}}_real above = servo->shown < least ? least : servo->shown;
    servo->shown = above > most ? most : above;
}

/* Call once in {{ID}}_STEP_S with the command that is held from now on; returns the position at the end
 * of the step. A command that is no number, or beyond 1e30, counts as the last one that is. */
static inline {{id}}_real {{id}}_step({{id}}_state *servo, {{id}}_real command)
{
    unsigned oldest = servo->newest + 1 < {{ID}}_LATE ? servo->newest + 1 : 0;
    unsigned next = oldest + 1 < {{ID}}_LATE ? oldest + 1 : 0;
    unsigned last = (servo->newest > 0 ? servo->newest : {{ID}}_LATE) - 1;
    servo->late[servo->newest] = command > -1e30f && command < 1e30f ? command : servo->late[last];
    servo->newest = oldest;
    {{id}}_real older = servo->late[oldest], newer = servo->late[next];
    /* The delayed command changes within the step: the motion is computed to there, and from there. */
    if (older < newer || older > newer) {
        {{id}}_advance(servo, {{id}}_delay_fraction * ({{id}}_real){{id}}_step_s, older);
        {{id}}_advance(servo, (1 - {{id}}_delay_fraction) * ({{id}}_real){{id}}_step_s, newer);
    } else {
        {{id}}_advance(servo, ({{id}}_real){{id}}_step_s, newer);
    }
    return {{id}}_position(servo);
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
