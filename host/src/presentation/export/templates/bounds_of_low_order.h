/* Covariance of {{covariance_of}} */
static const double {{id}}_covariance[{{parameter_count}}][{{parameter_count}}] = {
{{covariance}}
};
