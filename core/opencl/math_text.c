/* opencl/math_text.c -- embeds the words of bodies (see math_text.h, embed.h). */
#include "config.h"

#include "opencl/embed.h"
#include "opencl/math_text.h"

EMBED("math_text", "sph/lanes-math.h");
EMBED("words_text", "opencl/words.cl");
EMBED("words_end_text", "opencl/words_end.cl");
