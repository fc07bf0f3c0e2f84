const LEVEL = {{level}}
# Covariance of theta
const COVARIANCE = matrix("""
{{theta_covariance}}
""")
