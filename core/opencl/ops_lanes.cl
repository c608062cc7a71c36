/* opencl/ops_lanes.cl -- what is done to LANES particles at once, 1 or 8: this text is compiled for both. */
#if LANES == 8
#define reals double8
#define wholes int8
#define LANE(name) name##_8
#define TO_REALS(x) convert_double8(x)
#define TO_FLOATS(x) convert_float8(x)
#define TO_WHOLES(x) convert_int8(x)
#define LOAD(at) vload8(0, at)
#define STORE(x, at) vstore8(x, 0, at)
#define ANY(x) any(x)
#else
#define reals double
#define wholes int
#define LANE(name) name##_1
#define TO_REALS(x) ((double)(x))
#define TO_FLOATS(x) ((float)(x))
#define TO_WHOLES(x) ((int)(x))
#define LOAD(at) (*(at))
#define STORE(x, at) (*(at) = (x))
#define ANY(x) (x)
#endif

static inline reals LANE(get)(global const double *wide, global const float *narrow, uint slot,
                              uint k, ulong plane, ulong i)
{
    const ulong at = at_of(slot, k, plane) + i;
    if (slot & NARROW)
        return TO_REALS(LOAD(narrow + at));
    return LOAD(wide + at);
}

static inline void LANE(set)(global double *wide, global float *narrow, uint slot, uint k,
                             ulong plane, ulong i, reals value)
{
    const ulong at = at_of(slot, k, plane) + i;
    if (slot & NARROW)
        STORE(TO_FLOATS(value), narrow + at);
    else
        STORE(value, wide + at);
}

static inline void LANE(mirror)(global const double *wide, global float *narrow, ulong from,
                                ulong to, uint k, ulong plane, ulong i)
{
    STORE(TO_FLOATS(LOAD(wide + (from + k) * plane + i)), narrow + (to + k) * plane + i);
}

/* Whole numbers of a quantum. Returns whether one has no place: a difference of two must have room. */
static inline uint LANE(place)(global const double *wide, global float *narrow, ulong from,
                               ulong to, uint k, ulong plane, double centre, double inverse,
                               ulong i)
{
    const reals quanta = (LOAD(wide + (from + k) * plane + i) - centre) * inverse;
    const reals nearest = 0.5;
    STORE(TO_WHOLES(quanta + copysign(nearest, quanta)),
          (global int *)narrow + (to + k) * plane + i);
    return ANY(!(fabs(quanta) < 1073741824.0)) ? FLAG_NOWHERE : 0u;
}

static inline void LANE(keep)(global const double *wide, global const float *narrow, uint slot,
                              uint k, ulong plane, global double *kept, ulong i)
{
    STORE(LANE(get)(wide, narrow, slot, k, plane, i), kept + i);
}

/* A program of the integrator: see ops_advance.c. Returns whether a rate was no number. */
static inline uint LANE(advance)(global double *wide, global float *narrow, ulong plane,
                                 constant struct action *action, uint n_action, double dt, ulong i)
{
    reals none = 0.0;
    for (uint q = 0; q < n_action; q++) {
        constant struct action *x = action + q;
        for (uint k = 0; k < x->ncomp; k++) {
            reals y = LANE(get)(wide, narrow, x->base, k, plane, i);
            if (x->what & ACTION_SWAPS) {
                const reals other = LANE(get)(wide, narrow, x->to, k, plane, i);
                LANE(set)(wide, narrow, x->base, k, plane, i, other);
            }
            if (x->also != MISSING)
                y = x->w * y + x->w_also * LANE(get)(wide, narrow, x->also, k, plane, i);
            if (x->r != MISSING) {
                reals r = LANE(get)(wide, narrow, x->r, k, plane, i);
                none += r * 0.0;
                if (x->r0 != MISSING)
                    r -= LANE(get)(wide, narrow, x->r0, k, plane, i);
                y += x->a * dt * r;
            }
            if (x->r2 != MISSING)
                y += x->a2 * dt * dt * LANE(get)(wide, narrow, x->r2, k, plane, i);
            if (x->what & ACTION_RATE)
                none += y * 0.0;
            LANE(set)(wide, narrow, x->to, k, plane, i, y);
        }
    }
    return ANY(none != 0.0) ? FLAG_RATE : 0u;
}

#undef reals
#undef wholes
#undef LANE
#undef TO_REALS
#undef TO_FLOATS
#undef TO_WHOLES
#undef LOAD
#undef STORE
#undef ANY
