/* opencl/math_text.h -- texts that go to devices: sph/lanes-math.h, so that exp, log and pow there are those of
 * the native loops, and what else bodies are written with. */
#ifndef OPENCL_MATH_TEXT_H
#define OPENCL_MATH_TEXT_H

#define EMBEDDED extern __attribute__((visibility("hidden"))) const char

/* Each ends with NUL. */
EMBEDDED math_text[];
EMBEDDED words_text[];     /* opencl/words.cl */
EMBEDDED words_end_text[]; /* opencl/words_end.cl */

#undef EMBEDDED
#endif
