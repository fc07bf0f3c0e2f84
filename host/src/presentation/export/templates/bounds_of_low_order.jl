# Covariance of {{covariance_of}}
const LOW_ORDER_COVARIANCE = matrix("""
{{covariance}}
""")
