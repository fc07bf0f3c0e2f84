"""SysIdentPy: a polynomial NARX model, its terms chosen by FROLS."""

import numpy as np
from answer import Answer, joined
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS
from sysidentpy.parameter_estimation import LeastSquares

DEGREE = 2


def column(values, mean, scale):
    return ((values - mean) / scale).reshape(-1, 1)


def identify(task):
    u, y = joined(task)
    mean_u, mean_y, scale_u, scale_y = u.mean(), y.mean(), u.std(), y.std()
    model = FROLS(
        order_selection=True,
        n_info_values=20,
        ylag=3,
        xlag=16,
        info_criteria="bic",
        estimator=LeastSquares(),
        basis_function=Polynomial(degree=DEGREE),
    )
    model.fit(X=column(u, mean_u, scale_u), y=column(y, mean_y, scale_y))

    def simulate(u):
        # It wants first outputs to begin with; they are not known here, and the mean stands for them.
        start = np.zeros((model.max_lag, 1))
        return mean_y + scale_y * model.predict(X=column(u, mean_u, scale_u), y=start).ravel()

    return Answer(simulate)
