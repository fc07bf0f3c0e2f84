#define {{ID}}_LEVEL {{level}}

/* Its standard deviation, and its bounds for each point and for the whole curve. */
static const {{id}}_real {{id}}_step_sd[{{ID}}_TAPS] = {
{{sd}}
};
static const {{id}}_real {{id}}_step_lower[{{ID}}_TAPS] = {
{{lower}}
};
static const {{id}}_real {{id}}_step_upper[{{ID}}_TAPS] = {
{{upper}}
};
static const {{id}}_real {{id}}_step_lower_simultaneous[{{ID}}_TAPS] = {
{{lower_all}}
};
static const {{id}}_real {{id}}_step_upper_simultaneous[{{ID}}_TAPS] = {
{{upper_all}}
};
