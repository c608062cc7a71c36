/* plan/bodies.h -- functions that a scene brings as texts: registered like a plugin's, with what the scene
 * leaves out taken from the plugins that are loaded. */
#ifndef PLAN_BODIES_H
#define PLAN_BODIES_H

#include "plan/plan.h"

/* The name of the plugin that they make together. */
#define BODIES_PLUGIN "scene"

/* After all plugins have been loaded; the scene outlives the registry. EXIT_USAGE with the place. */
int bodies_register(struct registry *r, const struct scene *s, struct error *e);

/* Whether a step of the plan has only a text. */
bool bodies_any(const struct plan *plan);
/* Fails if one has, and another step is for processors alone: the scene runs nowhere. */
int bodies_fit(const struct plan *plan, struct error *e);
/* An error in a text of the scene is the scene's, not a plugin's: EXIT_USAGE. */
void bodies_blame(const struct plan *plan, struct error *e);
/* Fails, with the step's place, if the plan runs on the processor and a step has only a text. */
int bodies_need_device(const struct plan *plan, struct error *e);

#endif
