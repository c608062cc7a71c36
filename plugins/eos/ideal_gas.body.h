/* ideal_gas.body.h -- p = (gamma - 1) rho u, c^2 = gamma (gamma - 1) u. */
p = (gamma - 1) * rho * u;
cs = sqrt(gamma * (gamma - 1) * (u > 0 ? u : 0));
