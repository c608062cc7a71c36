/* stiffened-gas.body.h -- of one particle. */
p = (gamma - 1) * rho * u - gamma * p_inf;
/* Torn further apart than the model holds, the liquid carries no sound. */
cs = sqrt(gamma * fmax(p + p_inf, 0.0) / rho);
