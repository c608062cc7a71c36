/* limit.body.h -- for one particle, after the sweep: the time step that explicit diffusion may take. */
dt = h * h / fmax(diffusivity, 1e-300);
