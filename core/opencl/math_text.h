/* opencl/math_text.h -- texts that go to devices: sph/lanes-math.h, so that exp, log and pow there are those of
 * the native loops, and what else bodies are written with. */
#ifndef OPENCL_MATH_TEXT_H
#define OPENCL_MATH_TEXT_H

#include "opencl/embed.h"

/* Each ends with NUL. */
extern EMBEDDED math_text[];
extern EMBEDDED words_text[];     /* opencl/words.cl */
extern EMBEDDED words_end_text[]; /* opencl/words_end.cl */

#endif
