{{about}}
%
% A script that makes one structure, {{id}}. The fields finite_response, frequency_response and
% low_order need the Control System Toolbox, or Octave's package control.

{{id}} = struct();
{{id}}.name = '{{name}}';
{{id}}.bounds_hold = {{bounds_hold}}; % false: there are no bounds below, and no level
{{id}}.sample_period_s = {{period}};
{{id}}.sample_phase_s = {{phase}};
{{id}}.frame_s = {{frame}};
{{id}}.offset = {{offset}};
{{warning}}
% theta = [G0; Re G1; Im G1; ...]
{{id}}.theta = [ ...
{{theta}} ...
]';
{{bounds_of_parameters}}
% Step response: answers a unit step at sample 0
{{id}}.step_time_s = {{id}}.sample_period_s * (0:{{last}}) + {{id}}.sample_phase_s;
{{id}}.step = [ ...
{{step}} ...
];
{{bounds_of_step}}{{id}}.impulse = diff([0, {{id}}.step]);

% Frequency response of the samples, with the hold of the command between two of them
{{id}}.omega_rad_s = [ ...
{{omega}} ...
];
{{id}}.response = complex([ ...
{{re}} ...
], [ ...
{{im}} ...
]);
% The phase of the servo itself, freed of that hold, in degrees: for a continuous loop
{{id}}.servo_phase_deg = [ ...
{{servo_phase}} ...
];
{{bounds_of_frequency}}
% Position for a command u sampled every sample_period_s, without the offset: simulate(u), or simulate(u, before).
% The servo is at rest at the command before, or 0, until the first sample. A command that is no number
% leaves none of the later positions.{{of_response}}
{{id}}.simulate = @(u, varargin) filter({{id}}.impulse, 1, u - sum([varargin{:}])) + ...
    sum([varargin{:}]) * {{id}}.step(end);

if exist('OCTAVE_VERSION', 'builtin')
    try
        pkg('load', 'control');
    catch
    end
end
{{id}}.has_control = ~isempty(which('tf'));
if {{id}}.has_control
    {{id}}.finite_response = tf({{id}}.impulse, [1, zeros(1, {{last}})], {{id}}.sample_period_s);
    {{id}}.frequency_response = frd({{id}}.response, {{id}}.omega_rad_s, {{id}}.sample_period_s);
else
    warning('servoid:control', ['Without the Control System Toolbox, or Octave''s package control ', ...
        '(pkg install -forge control), the structure {{id}} has no transfer functions.']);
end

{{low_order}}
