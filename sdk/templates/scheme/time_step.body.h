/* time_step.body.h -- for one particle, after the sweep: the time step that it allows. */
dt = h / (cs + 0.6 * (alpha * cs + beta * fastest));
