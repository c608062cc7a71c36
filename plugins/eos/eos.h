/* eos.h -- the equations of state of this plugin. */
#ifndef EOS_H
#define EOS_H

#include <sph/eos.h>

extern const sph_eos ideal_gas; /* ideal_gas.c */
extern const sph_eos linear;    /* linear.c */
extern const sph_eos tait;      /* tait.c */

#endif
