# Covariance of {{covariance_of}}
LOW_ORDER_COVARIANCE = np.array([
{{covariance}}
])
