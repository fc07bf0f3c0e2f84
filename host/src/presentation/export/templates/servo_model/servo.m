function [position, servo] = {{id}}(command, servo)
{{about}}
%
% A function, in a file of its name: {{id}}.m. position = {{id}}(command) has the positions at the
% ends of steps of step_s with these commands, from rest under the first of them. To go on from there,
% [position, servo] = {{id}}(command, servo) takes and gives the state.

p = parameters();
if nargin < 2
    servo = at_rest(command(1), p);
end
position = zeros(size(command));
for k = 1:numel(command)
    servo = step(servo, command(k), p);
    position(k) = p.gain * servo.angle + p.offset;
end
end

function p = parameters()
p.name = '{{name}}';
p.step_s = {{step}};
p.delay_steps = {{delay_steps}}; % whole steps
{{parameters}}
p.half_motor = 0.5 * p.step_s * p.motor_damping;
end

function servo = at_rest(command, p)
% At rest under a command.
angle = command;
for k = 1:25
    angle = 0.5 * (angle + command - load_at(angle, p) / p.stiffness);
end
servo = struct('angle', angle, 'speed', 0.0, 'late', command * ones(1, p.delay_steps + 2), 'newest', 0);
end

function servo = step(servo, command, p)
% Goes on by step_s, in which the command was held.
[delayed, servo] = delay(servo, command, p);
middle = servo.angle + 0.5 * p.step_s * servo.speed;
error = nearer_zero(delayed - middle, p.dead_band);
loaded = servo.speed * (1.0 - p.half_motor) - p.step_s * load_at(middle, p);

ratio = 1.0;
largest = p.step_s * p.full_drive;
if unlimited_drive(error, servo.speed, loaded, 1.0, p) < 0.0
    ratio = p.down_to_up;
    largest = -largest * p.down_to_up;
end
if abs(unlimited_drive(error, servo.speed, loaded, ratio, p)) > abs(largest)
    pushed = largest;
    left = 1.0 / (1.0 + p.half_motor);
else
    pushed = push(error, servo.speed, ratio, p);
    left = damped(ratio, p);
end

relative = servo.speed / p.friction_speed;
held = p.friction * (1.0 + p.friction_at_rest / (1.0 + relative * relative));
servo.speed = nearer_zero((loaded + pushed) * left, p.step_s * left * held);
servo.angle = middle + 0.5 * p.step_s * servo.speed;
end

function [delayed, servo] = delay(servo, command, p)
% The mean of the delayed command over a step that begins with the command.
count = numel(servo.late);
servo.late(servo.newest + 1) = command;
servo.newest = mod(servo.newest + 1, count);
older = servo.late(servo.newest + 1);
newer = servo.late(mod(servo.newest + 1, count) + 1);
delayed = p.delay_fraction * older + (1.0 - p.delay_fraction) * newer;
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

% The loop as if the drive had no limit, with ratio times its constants.

function taken = braking(ratio, p)
% What the loop's damping takes of the speed at each end of a step.
taken = 0.5 * p.step_s * (p.damping - p.motor_damping) * ratio;
end

function factor = damped(ratio, p)
% The factor by which damping leaves the speed.
factor = 1.0 / (1.0 + p.half_motor + braking(ratio, p));
end

function change = push(error, speed, ratio, p)
% Change of speed in a step by the error, and by the speed at its beginning.
change = error * p.step_s * p.stiffness * ratio - speed * braking(ratio, p);
end

function change = unlimited_drive(error, speed, loaded, ratio, p)
% Change of speed in a step by the drive; loaded is the speed after load and the motor's damping.
pushed = push(error, speed, ratio, p);
change = pushed - (loaded + pushed) * damped(ratio, p) * braking(ratio, p);
end
