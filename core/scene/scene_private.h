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
int scene_scheme(struct scene *s, const cJSON *node, struct error *e);
int scene_compares(struct scene *s, const cJSON *node, struct error *e);
int scene_probes(struct scene *s, const cJSON *node, struct error *e);
int scene_output(struct scene *s, const cJSON *node, struct error *e);
int scene_watches(struct scene *s, const cJSON *node, struct error *e);
int scene_time(struct scene *s, const cJSON *node, struct error *e);

#define COUNT(array) (sizeof(array) / sizeof *(array))

#endif
