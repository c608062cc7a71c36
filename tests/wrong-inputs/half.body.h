half_q = 0.5 * q * h;
