/* look.macros.h -- words of look.body.h. */
#define MEAN_OF(name) (0.5 * (name##_i + name##_i))
