function [position, servo] = {{id}}(command, servo)
{{about}}
%
% A function, in a file of its name: {{id}}.m. position = {{id}}(command) has the positions at the
% ends of steps of step_s with these commands, from rest under the first of them. To go on from there,
% [position, servo] = {{id}}(command, servo) takes and gives the state.

p = parameters();
if nargin < 2 || isempty(servo)
    servo = at_rest(command(1), p);
end
position = zeros(size(command));
for k = 1:numel(command)
    servo = step(servo, command(k), p);
    position(k) = p.gain * servo.shown + p.offset;
end
end

function p = parameters()
p.name = '{{name}}';
p.step_s = {{step}};
p.delay_steps = {{delay_steps}}; % whole steps
{{parameters}}
end

function servo = at_rest(command, p)
% At rest under a command, which must be a number.
lower = between_stops(end_of_rest(command, 1.0, p), p);
upper = between_stops(end_of_rest(command, -1.0, p), p);
angle = 0.5 * (lower + upper);
% shown is phi, the angle that the position shows: in the middle of the play.
servo = struct('angle', angle, 'speed', 0.0, 'shown', angle, 'late', command * ones(1, p.delay_steps + 2), 'newest', 0);
end

% Rest: the shaft stays at all angles at which the drive differs from the load by no more than friction
% holds. It rests in the middle of them; last is -1 for the upper end of them and 1 for the lower.

function side = side_of(drive, ratio)
% ratio where a drive of this sign is negative.
side = 1.0;
if drive < 0.0
    side = ratio;
end
end

function drive = held_by(angle, last, p)
% The drive that just holds the shaft at an end.
load = load_at(angle, p);
more = last * (1.0 + p.friction_at_rest);
own = more * p.friction;
share = more * p.friction_of_gears;
drive = load; % friction that holds any drive counts as none
if abs(share) < 1.0
    if 2.0 * load + own < 0.0
        share = -share;
    end
    drive = (load * (1.0 + share) + own) / (1.0 - share);
end
end

function error = error_of(drive, p)
% The error at rest under which a drive without limit is this.
error = drive / (p.stiffness * side_of(drive, p.loop_down_to_up)) + sign(drive) * p.dead_band;
end

function more = excess(command, angle, last, p)
% By how much the drive at rest is more than the one that holds the shaft.
seen = nearer_zero(command - angle, p.dead_band);
largest = p.full_drive * side_of(seen, p.down_to_up);
drive = p.stiffness * side_of(seen, p.loop_down_to_up) * seen;
more = max(-largest, min(largest, drive)) - held_by(angle, last, p);
end

function angle = end_of_rest(command, last, p)
% The angle of an end: where the shaft comes to from the command, slowly. A load that full drive does not
% hold has no rest: then that of a drive without limit.
off = error_of(held_by(command, last, p), p);
side = -sign(off);
near = 0.0;
far = abs(off);
pulled = @(distance) side * excess(command, command + side * distance, last, p) > 0.0;
for k = 1:8
    if pulled(far)
        near = far;
        far = 2.0 * far;
    end
end
if pulled(far)
    angle = command - off;
    return
end
for k = 1:60
    middle = 0.5 * (near + far);
    if pulled(middle)
        near = middle;
    else
        far = middle;
    end
end
angle = command + side * far;
end

function servo = step(servo, command, p)
% Goes on by step_s, in which the command was held. One that is no number, or beyond 1e30, counts as the
% last one that is.
count = numel(servo.late);
if ~(abs(command) < 1e30)
    command = servo.late(mod(servo.newest - 1, count) + 1);
end
servo.late(servo.newest + 1) = command;
servo.newest = mod(servo.newest + 1, count);
older = servo.late(servo.newest + 1);
newer = servo.late(mod(servo.newest + 1, count) + 1);
% The delayed command changes within the step: the motion is computed to there, and from there.
if older == newer
    servo = advance(servo, p.step_s, newer, p);
else
    servo = advance(servo, p.delay_fraction * p.step_s, older, p);
    servo = advance(servo, (1.0 - p.delay_fraction) * p.step_s, newer, p);
end
end

function servo = advance(servo, h, command, p)
% The motion of h seconds under a command, without delay.
middle = servo.angle + 0.5 * h * servo.speed;
error = nearer_zero(command - middle, p.dead_band);
load = h * load_at(middle, p);
loaded = servo.speed * (1.0 - half_motor(h, p)) - load;

ratio = 1.0;
largest = h * p.full_drive;
if unlimited_drive(h, error, servo.speed, loaded, 1.0, p) < 0.0
    ratio = p.loop_down_to_up;
    largest = -largest * p.down_to_up;
end
drive = unlimited_drive(h, error, servo.speed, loaded, ratio, p);
if abs(drive) > abs(largest)
    drive = largest;
    pushed = largest;
    left = 1.0 / (1.0 + half_motor(h, p));
else
    pushed = push(h, error, servo.speed, ratio, p);
    left = damped(h, ratio, p);
end

held = h * p.friction + p.friction_of_gears * abs(drive + load);
before = servo.speed;
wanted = braked(before, (loaded + pushed) * left, left * held, p);
servo.speed = max(p.lowest_speed, min(p.highest_speed, wanted));
servo.angle = middle + 0.5 * h * servo.speed;
% The speed stays at its limit for the rest of the step.
if servo.speed ~= wanted && servo.speed ~= before
    share = (wanted - servo.speed) / (wanted - before);
    servo.angle = servo.angle + 0.5 * h * (servo.speed - before) * share;
end
% A stop takes all speed.
if servo.angle ~= between_stops(servo.angle, p)
    servo.angle = between_stops(servo.angle, p);
    servo.speed = 0.0;
end
% Behind its play the position is taken along.
servo.shown = max(servo.angle - 0.5 * p.play, min(servo.angle + 0.5 * p.play, servo.shown));
end

function held = friction_at(speed, held, p)
% What friction takes at a speed, where it takes this at high ones.
relative = speed / p.friction_speed;
held = held * (1.0 + p.friction_at_rest / (1.0 + relative * relative));
end

function speed = released(wanted, held, p)
% The speed after a step from rest, where it would be this without friction.
speed = nearer_zero(wanted, friction_at(0.0, held, p));
if speed ~= 0.0
    speed = wanted - sign(speed) * friction_at(0.5 * speed, held, p);
end
end

function after = braked(speed, wanted, held, p)
% The speed after a step, where it would be the wanted one without friction. Friction is that in the middle of
% the step; a shaft that comes to rest within the step is held or turns round for what is left of it.
if speed == 0.0
    after = released(wanted, held, p);
    return
end
slowed = wanted - sign(speed) * friction_at(speed, held, p);
middle = 0.5 * speed;
if sign(speed) * slowed > 0.0
    middle = 0.5 * (speed + slowed);
end
after = wanted - sign(speed) * friction_at(middle, held, p);
if sign(speed) * after < 0.0
    after = released(wanted - speed, held, p) * (after / (after - speed));
end
end

function angle = between_stops(angle, p)
% The angle, no farther than the stops.
angle = max(p.lowest_angle, min(p.highest_angle, angle));
end

function acceleration = load_at(angle, p)
% What the load takes at an angle.
acceleration = {{load}};
end

function value = nearer_zero(value, width)
% The value moved towards zero by the width, and zero where it would pass it.
if value > width
    value = value - width;
elseif value < -width
    value = value + width;
else
    value = 0.0;
end
end

% The loop as if the drive had no limit, with ratio times its constants, over h seconds.

function taken = half_motor(h, p)
% Half of what the motor's damping takes of the speed.
taken = 0.5 * h * p.motor_damping;
end

function taken = braking(h, ratio, p)
% What the loop's damping takes of the speed at each end.
taken = 0.5 * h * (p.damping - p.motor_damping) * ratio;
end

function factor = damped(h, ratio, p)
% The factor by which damping leaves the speed.
factor = 1.0 / (1.0 + half_motor(h, p) + braking(h, ratio, p));
end

function change = push(h, error, speed, ratio, p)
% Change of speed by the error, and by the speed at the beginning.
change = error * h * p.stiffness * ratio - speed * braking(h, ratio, p);
end

function change = unlimited_drive(h, error, speed, loaded, ratio, p)
% Change of speed by the drive; loaded is the speed after load and the motor's damping.
pushed = push(h, error, speed, ratio, p);
change = pushed - (loaded + pushed) * damped(h, ratio, p) * braking(h, ratio, p);
end
