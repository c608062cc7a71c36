/* integrators/families.h -- the integrators that there are, one file a family. */
#ifndef INTEGRATORS_FAMILIES_H
#define INTEGRATORS_FAMILIES_H

#include "integrators/integrator.h"

extern const struct integrator integrator_kdk;
extern const struct integrator integrator_pec;

#endif
