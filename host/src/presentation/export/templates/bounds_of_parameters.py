LEVEL = {{level}}
# Covariance of theta
COVARIANCE = np.array([
{{theta_covariance}}
])
