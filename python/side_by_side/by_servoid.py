"""servoid: the linear model, and the servo as a machine where that one has no bounds."""

import servoid
from answer import Answer


def identify(task):
    u, y = zip(*task.seen)
    model = servoid.identify(list(u), list(y), period=task.period_s, at_rest=task.before)
    if model.servo_model is not None:
        return Answer(lambda u: model.servo_model.simulate(u, at_rest=task.before).value)
    return Answer(lambda u: model.simulate(u, at_rest=task.before), model.step.pointwise_lower, model.step.pointwise_upper)
