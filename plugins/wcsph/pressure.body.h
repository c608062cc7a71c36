/* pressure.body.h -- p / rho^2. */
p_rho2 = p / (rho * rho);
