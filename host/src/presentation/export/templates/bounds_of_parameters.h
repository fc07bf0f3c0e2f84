/* Their covariance, for programs that carry the uncertainty on: {{theta_bytes}} bytes with the parameters. */
static const double {{id}}_theta_covariance[{{ID}}_PARAMETERS][{{ID}}_PARAMETERS] = {
{{theta_covariance}}
};
