/* ---- Discrete state space of the low-order model: {{order}} multiply-adds each way, not N ---- */

#define {{ID}}_ORDER {{order}}
#define {{ID}}_DELAY_SAMPLES {{delay_samples}}
#define {{ID}}_LARGEST_ERROR_PERCENT {{largest_error}} /* {{of_error}} */
#define {{ID}}_GAIN {{gain}}
/* What its positions are without. It differs from {{ID}}_OFFSET as the gains do: at rest at a command of {{offset_at}} both
 * models have the same position. */
#define {{ID}}_LOW_ORDER_OFFSET {{low_order_offset}}
#define {{ID}}_DELAY_S {{delay}}
{{parameters}}
{{bounds_of_low_order}}
/* x(k+1) = A x(k) + B u(k-m), y(k) = C x(k) + D u(k-m), m = {{ID}}_DELAY_SAMPLES */
static const {{id}}_real {{id}}_a[{{ID}}_ORDER][{{ID}}_ORDER] = {
{{a}}
};
static const {{id}}_real {{id}}_b[{{ID}}_ORDER] = { {{b}} };
static const {{id}}_real {{id}}_c[{{ID}}_ORDER] = { {{c}} };
static const {{id}}_real {{id}}_d = {{d}};
/* x at rest at a command of 1 */
static const {{id}}_real {{id}}_rest[{{ID}}_ORDER] = { {{rest}} };

typedef struct {
    {{id}}_real x[{{ID}}_ORDER];
    {{id}}_real late[{{ID}}_DELAY_SAMPLES + 1]; /* a ring of commands */
    unsigned newest;
} {{id}}_ss;

/* At rest at this command, which must be a number. */
static inline void {{id}}_ss_reset({{id}}_ss *servo, {{id}}_real command)
{
    for (unsigned i = 0; i < {{ID}}_ORDER; i++) {
        servo->x[i] = {{id}}_rest[i] * command;
    }
    for (unsigned i = 0; i <= {{ID}}_DELAY_SAMPLES; i++) {
        servo->late[i] = command;
    }
    servo->newest = 0;
}

/* Call once each sample period with the command that is applied from now on; returns the position
 * {{ID}}_SAMPLE_PHASE_S later, without {{ID}}_LOW_ORDER_OFFSET. A command that is no number, or beyond 1e30,
 * counts as the last one that is. */
static inline {{id}}_real {{id}}_ss_step({{id}}_ss *servo, {{id}}_real command)
{
    {{id}}_real next[{{ID}}_ORDER];
    unsigned oldest = servo->newest + 1;
    if (oldest > {{ID}}_DELAY_SAMPLES) {
        oldest = 0;
    }
    unsigned last = (servo->newest > 0 ? servo->newest : {{ID}}_DELAY_SAMPLES + 1) - 1;
    servo->late[servo->newest] = command > -1e30f && command < 1e30f ? command : servo->late[last];
    servo->newest = oldest;
    {{id}}_real late = servo->late[oldest];
    {{id}}_real position = {{id}}_d * late;
    for (unsigned i = 0; i < {{ID}}_ORDER; i++) {
        position += {{id}}_c[i] * servo->x[i];
        next[i] = {{id}}_b[i] * late;
        for (unsigned j = 0; j < {{ID}}_ORDER; j++) {
            next[i] += {{id}}_a[i][j] * servo->x[j];
        }
    }
    for (unsigned i = 0; i < {{ID}}_ORDER; i++) {
        servo->x[i] = next[i];
    }
    return position;
}

