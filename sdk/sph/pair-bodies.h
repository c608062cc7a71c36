/* sph/pair-bodies.h -- the bodies of one pair, each in a scope of its own; the inside of the
 * loops. */
{
#include SPH_LOOP_BODY
}
#ifdef SPH_LOOP_BODY_2
{
#include SPH_LOOP_BODY_2
}
#endif
#ifdef SPH_LOOP_BODY_3
{
#include SPH_LOOP_BODY_3
}
#endif
#ifdef SPH_LOOP_BODY_4
{
#include SPH_LOOP_BODY_4
}
#endif
