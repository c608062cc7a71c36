/* opencl/math_text.c -- embeds texts for devices by the assembler, as the SDK does those of bodies (see
 * math_text.h). Global, for link time optimisation puts what the assembler makes and what reads it
 * into different objects. core/fragment.am says what it is made from: no compiler would. */
#include "config.h"

#include "opencl/math_text.h"

#define EMBED(name, file)                                                                          \
    __asm__(".pushsection .rodata\n"                                                               \
            ".globl " name "\n"                                                                    \
            ".hidden " name "\n"                                                                   \
            ".type " name ", %object\n" name ":\n"                                                 \
            ".incbin \"" file "\"\n"                                                               \
            ".byte 0\n"                                                                            \
            ".size " name ", . - " name "\n"                                                       \
            ".popsection\n")

EMBED("math_text", "sph/lanes-math.h");
EMBED("words_text", "opencl/words.cl");
EMBED("words_end_text", "opencl/words_end.cl");
