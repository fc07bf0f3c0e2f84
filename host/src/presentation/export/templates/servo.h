/*
{{about}}
 *
 * C99, no allocation, no other header. {{id}}_real is float unless {{ID}}_REAL says otherwise, for
 * example -D{{ID}}_REAL=double.
 */
#ifndef {{ID}}_H
#define {{ID}}_H

/* Constants have all their digits, which a float rounds. */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#endif

#ifndef {{ID}}_REAL
#define {{ID}}_REAL float
#endif
#ifndef {{ID}}_NAME /* the servo model of this servo has both, too */
#define {{ID}}_NAME "{{name}}"
typedef {{ID}}_REAL {{id}}_real;
#endif
#define {{ID}}_BOUNDS_HOLD {{bounds_hold}} /* 0: there are no bounds below, and no level */
#define {{ID}}_SAMPLE_PERIOD_S {{period}}
#define {{ID}}_SAMPLE_PHASE_S {{phase}}
#define {{ID}}_FRAME_S {{frame}}
#define {{ID}}_OFFSET {{offset}}

/* ---- Finite impulse response: the identified model itself ---- */

#define {{ID}}_TAPS {{taps}}

/* h(i), i = 0 .. N-1 */
static const {{id}}_real {{id}}_impulse[{{ID}}_TAPS] = {
{{impulse}}
};

/* The answer to a unit step: h summed up. The last element is the gain. */
static const {{id}}_real {{id}}_step_response[{{ID}}_TAPS] = {
{{step}}
};
{{bounds_of_step}}
/* The parameters of all this (see Parameters above), for programs that define {{ID}}_WITH_THETA before they
 * include this. */
#ifdef {{ID}}_WITH_THETA
#define {{ID}}_PARAMETERS {{theta_count}}
static const double {{id}}_theta[{{ID}}_PARAMETERS] = {
{{theta}}
};
{{bounds_of_parameters}}#endif

typedef struct {
    {{id}}_real past[{{ID}}_TAPS]; /* a ring of commands */
    unsigned newest;
} {{id}}_fir;

/* At rest at this command, which must be a number. */
static inline void {{id}}_fir_reset({{id}}_fir *servo, {{id}}_real command)
{
    for (unsigned i = 0; i < {{ID}}_TAPS; i++) {
        servo->past[i] = command;
    }
    servo->newest = 0;
}

/* Call once each sample period with the command that is applied from now on; returns the position
 * {{ID}}_SAMPLE_PHASE_S later, without the offset. A command that is no number, or beyond 1e30, counts as
 * the last one that is.{{of_response}} */
static inline {{id}}_real {{id}}_fir_step({{id}}_fir *servo, {{id}}_real command)
{
    {{id}}_real position = 0;
    unsigned at = servo->newest + 1;
    if (at == {{ID}}_TAPS) {
        at = 0;
    }
    servo->past[at] = command > -1e30f && command < 1e30f ? command : servo->past[servo->newest];
    servo->newest = at;
    for (unsigned i = 0; i < {{ID}}_TAPS; i++) {
        position += {{id}}_impulse[i] * servo->past[at];
        at = (at == 0 ? {{ID}}_TAPS : at) - 1;
    }
    return position;
}

{{low_order}}
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
