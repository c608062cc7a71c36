/* viscosity-step.body.h -- the time step that viscosity allows a particle, before the scene's cfl: with 0.3 of
 * it, 0.125 h^2 / nu (Morris, Fox & Zhu 1997, eq. 33). */
viscous_dt = 0.42 * h * h / nu;
