% Low-order model: K exp(-L s) / denominator(s)
{{id}}.order = {{order}};
{{id}}.gain = {{gain}};
% What its positions are without. It differs from offset as the gains do: at rest at a command of {{offset_at}} both models have the same position.
{{id}}.low_order_offset = {{low_order_offset}};
{{id}}.delay_s = {{delay}};
{{id}}.denominator = [{{denominator}}]; % falling powers of s
{{id}}.largest_error_percent = {{largest_error}}; % {{of_error}}
{{bounds_of_low_order}}
% The same by samples, exactly: x(k+1) = A x(k) + B u(k-m), y(k) = C x(k) + D u(k-m)
{{id}}.A = [ ...
{{a}} ...
];
{{id}}.B = [{{b}}]';
{{id}}.C = [{{c}}];
{{id}}.D = {{d}};
{{id}}.delay_samples = {{delay_samples}};
if {{id}}.has_control
    {{id}}.low_order = tf([{{numerator_z}}], [{{denominator_z}}, zeros(1, {{delay_samples}})], ...
        {{id}}.sample_period_s);
    if exist('OCTAVE_VERSION', 'builtin')
        % Octave's tf has no delay: add delay_s yourself.
        {{id}}.continuous = tf({{id}}.gain, {{id}}.denominator);
    else
        {{id}}.continuous = tf({{id}}.gain, {{id}}.denominator, 'InputDelay', {{id}}.delay_s);
    end
end
