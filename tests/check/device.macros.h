/* device.macros.h -- what device.body.h has besides the words: for the native build by an #include,
 * for a device as the prelude. */
#define NEARER(a, b) sph_min((a), (b))
#define TWO 2.0
