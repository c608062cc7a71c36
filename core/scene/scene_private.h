/* scene/scene_private.h -- what the files scene*.c share: memory that lives as long as the
 * scene, and one function for each part of a scene. */
#ifndef SCENE_PRIVATE_H
#define SCENE_PRIVATE_H

#include "scene/scene.h"

/* n zeroed elements (of at least one), freed with the scene; NULL with the error set. */
void *scene_alloc(struct scene *s, size_t n, size_t size, struct error *e);
/* A shape that is freed with the scene. */
int scene_shape(struct scene *s, const cJSON *node, struct shape **out, struct error *e);

/* Fails unless `node`, a string, is an expression of the first n variables. */
int scene_check_expression(const struct scene *s, const cJSON *node, size_t n, struct error *e);
/* Fails unless `node` is a number, an expression, or an array of up to 9 of them. */
int scene_check_field(const struct scene *s, const cJSON *node, struct error *e);
/* An array of texts, member `key` (or one text alone); `*out` stays NULL if absent. */
int scene_strings(struct scene *s, const cJSON *object, const char *key, const char ***out,
                  size_t *n, struct error *e);
/* The same, of names of the scene's arrays. */
int scene_arrays(struct scene *s, const cJSON *object, const char *key, const char ***out,
                 size_t *n, struct error *e);
/* A member that names one of the scene's arrays. */
int scene_array_name(const struct scene *s, const cJSON *object, const char *key, bool required,
                     const char **out, struct error *e);
/* A member that is one of words[0..n); *index is untouched if it is absent. */
int scene_word(const struct scene *s, const cJSON *object, const char *key, const char *what,
               const char *const *words, size_t n, size_t *index, struct error *e);
/* A name for an array, a material, a column: letters, digits, "_" and, if `dash`, "-". */
int scene_name(const struct scene *s, const cJSON *node, bool dash, struct error *e);

int scene_particles(struct scene *s, const cJSON *node, struct error *e);
int scene_fill(struct scene *s, const cJSON *node, struct scene_fill *fill, struct error *e);
int scene_functions(struct scene *s, const cJSON *node, struct error *e);
int scene_scheme(struct scene *s, const cJSON *node, struct error *e);
int scene_compares(struct scene *s, const cJSON *node, struct error *e);
int scene_probes(struct scene *s, const cJSON *node, struct error *e);
int scene_profiles(struct scene *s, const cJSON *node, struct error *e);

/* scene_declared.c: "properties", "parameters", "rates" and "reductions" of a function. */
struct scene_function;
int scene_declared(struct scene *s, const cJSON *node, struct scene_function *f, struct error *e);
/* Whether `name` is a name of C that is none of the SDK's. */
bool scene_is_identifier(const char *name);
/* Whether a body has the name already, or C or OpenCL C keep it for themselves. side: one that gets _i or _j. */
bool scene_is_taken(const char *name, bool side);

/* scene_sample.c: parts of what is measured. Member "where", if given: an expression of a particle's
 * position. */
int scene_where(struct scene *s, const cJSON *node, const char **out, struct error *e);
/* The list under `node`: room for it; an absent one is empty. */
int scene_list(struct scene *s, const cJSON *node, const char *what, size_t size, void **out,
               struct error *e);
/* Members "every", "steps" and, of a comparison, "at". */
int scene_moments(struct scene *s, const cJSON *node, bool with_at, struct scene_moments *out,
                  struct error *e);
/* Member "time": a moment within the run's. */
int scene_time_of(struct scene *s, const cJSON *node, double *out, struct error *e);
/* Members "center" and "axis". */
int scene_about(struct scene *s, const cJSON *node, struct scene_about *out, struct error *e);
int scene_along(struct scene *s, const cJSON *node, enum along *out, struct error *e);
/* Members "array", "of", "plain", "center" and "axis". */
int scene_sample(struct scene *s, const cJSON *node, struct scene_sample *out, struct error *e);
/* Member "at": a point or several. */
int scene_points(struct scene *s, const cJSON *node, struct scene_sample *out, struct error *e);
/* Members "from", "to" and "points". */
int scene_line(struct scene *s, const cJSON *node, struct scene_sample *out, struct error *e);
/* Member "reference" of a probe that measures at `when`. */
int scene_reference(struct scene *s, const cJSON *node, const struct scene_moments *when,
                    struct scene_reference *out, struct error *e);
/* Whether the names of two probes give files of one name. */
bool scene_same_file(const char *a, const char *b);
int scene_output(struct scene *s, const cJSON *node, struct error *e);
int scene_watches(struct scene *s, const cJSON *node, struct error *e);
int scene_time(struct scene *s, const cJSON *node, struct error *e);

#define COUNT(array) (sizeof(array) / sizeof *(array))

#endif
