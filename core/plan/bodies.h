/* plan/bodies.h -- functions that a scene brings as texts: registered like a plugin's, with what the scene
 * leaves out taken from the plugins that are loaded. */
#ifndef PLAN_BODIES_H
#define PLAN_BODIES_H

#include "plan/plan.h"

/* The name of the plugin that they make together. */
#define BODIES_PLUGIN "scene"

/* After all plugins have been loaded; the scene outlives the registry. EXIT_USAGE with the place. */
int bodies_register(struct registry *r, const struct scene *s, struct error *e);

/* Fails, with the step's place, if the plan runs on the processor and a step has only a text. */
int bodies_need_device(const struct plan *plan, struct error *e);

#endif
