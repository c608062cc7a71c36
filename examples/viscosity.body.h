/* viscosity.body.h -- one pair of the viscosity of a Newtonian fluid, sum_j m_j nu (rho_i + rho_j) / (rho_i rho_j)
 * (1/r dW/dr) (v_i - v_j): Morris, Fox & Zhu 1997, eq. 22. */
const R slope = sph_grad(K, m_j, r, 0.5 * (hinv_i + hinv_j));
const R pull = nu * slope * (rho_i + rho_j) / (rho_i * rho_j);
for (int c = 0; c < DIM; c++)
    sph_add(a[c], pull * (v_i[c] - v_j[c]));
