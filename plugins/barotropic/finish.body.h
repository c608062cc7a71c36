/* finish.body.h -- of one particle, the time step that it allows: so that the scene's cfl is just C = c dt / h. */
dt = h / cs;
