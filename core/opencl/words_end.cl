/* opencl/words_end.cl -- what words.cl began, behind sph/lanes-math.h. */
#undef sph_int
#undef sph_bits
#undef sph_of_bits
#undef I
#undef SPH_HOLDS

/* a^b in the masked lanes, 1 in the others. */
SPH_FN(R, sph_pow_where_, (B m, R a, R b))
{
    const R one = sph_num(1.0);
    return sph_select(m, sph_pow(sph_select(m, a, one), b), one);
}
