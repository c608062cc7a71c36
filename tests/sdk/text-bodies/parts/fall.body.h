/* fall.body.h -- gravity along x, slowed down. */
for (int c = 0; c < DIM; c++)
    push[c] -= K_drag * v[c];
push[0] += g;
pace = 1.0;
