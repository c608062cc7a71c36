/* motion.h -- functions with answers that a test can work out by itself: a spring, sums over neighbours
 * with weights that vanish at the edge of the reach, passes that iterate. */
#ifndef TESTS_UNIT_MOTION_H
#define TESTS_UNIT_MOTION_H

#include "rig.h"
#include "run/run.h"

/* Schemes: "swing" (spring), "coast" (nothing but x by v). Functions:
 *   spring       a = -x - damping v
 *   pull         adds 1 to a_x, which begins at 0.25, and to "pulled", which is no rate
 *   bound        dt = early, from t = 0.5 on late; bounds the time step
 *   measure      "value" as it stands: minimum, maximum, sum and a bound of the time step
 *   count-up     done += 1 a sweep until it is "need", at most six sweeps
 *   breathe      h = "h0" (1 + depth sin(9 t + colour))
 *   shade        q = colour + t, w = v + t e_x
 *   gather       s = sum m_j q_j f, sv = sum m_j w_j f; f = (1 - r / reach_i)^2 if r < reach_i
 *   gather-both  "both": as s, with the larger reach of the two
 *   widen        h grows by a third a sweep until "enough" neighbours stand within 2 h; "found": how many */
extern const struct rig_items motion_items;

#define MOTION_SUPPORT 2.0 /* of the kernel "thing" */

/* Relative difference of the columns that `gather` ("s", "sv") or `gather-both` ("both") has left in
 * array `dst` from the sum over all particles of the n_src arrays and their images. */
double motion_error(const struct run *r, bool both, size_t dst, const size_t *src, size_t n_src);

#endif
