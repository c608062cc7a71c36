/* plan/inside.h -- the parts of plan_make, in the order in which they run; for core/plan alone. */
#ifndef PLAN_INSIDE_H
#define PLAN_INSIDE_H

#include "plan/plan.h"

/* recipe.c: the scheme's steps, edited by the scene. */
int recipe_make(struct plan *plan, struct error *e);
void recipe_free(struct plan *plan);
/* columns.c: arrays with the columns that every scene has, and the user's own. */
int columns_begin(struct plan *plan, bool guarded, struct error *e);
/* bind.c: steps to passes, one for each destination array. */
int bind_passes(struct plan *plan, struct error *e);
int bind_columns(struct plan *plan, struct binding *b, size_t array, const sph_item *item,
                 uint32_t access_mask, struct error *e);
void bind_free(struct plan *plan);
/* assignment.c: an expression of the scene as a pass. */
int assignment_bind(struct plan *plan, struct pass *pass, const struct step *s, size_t array,
                    struct error *e);
void assignment_free(struct assignment *a);
/* columns.c: which columns are state, which need an initial value, the rates, the integrator's own. */
int columns_finish(struct plan *plan, struct error *e);

/* measures.c: what the scene wants measured is there; exact solutions and tables are made ready. */
int asked_bind(struct plan *plan, struct error *e);
void asked_free(struct plan *plan);

/* fusion.c: how many of the steps from `first` on are one function's parts (0: none), and which it is. */
size_t fusion_find(const struct plan *plan, size_t first, const struct entry **whole);
/* backend.c: whether the run is on the device that the scene asks for; where it can not be, says so in a line, or
 * fails. */
int backend_decide(struct plan *plan, struct error *e);
/* precision.c: which passes work in floats, which columns are held in them. */
int precision_decide(struct plan *plan, struct error *e);
/* closing.c: of every rate, which pass corrects its property; needs to know how columns are held. */
void closing_find(struct plan *plan);
/* Fails at a scene node with " (did you mean ...)" over a registry kind's names. */
int plan_unknown(const struct plan *plan, const cJSON *node, enum kind kind, const char *name,
                 struct error *e);
/* A printf into fresh memory with its failure told. */
int plan_name(char **out, struct error *e, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Grows an array by one zeroed element and returns it, or NULL. */
void *plan_grow(void *array, size_t *n, size_t size);

#endif
