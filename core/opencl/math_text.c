/* opencl/math_text.c -- embeds a header's text by the assembler, as the SDK does those of bodies (see
 * math_text.h). Global, for link time optimisation puts what the assembler makes and what reads it
 * into different objects. core/fragment.am says what it is made from: no compiler would. */
#include "config.h"

#include "opencl/math_text.h"

__asm__(".pushsection .rodata\n"
        ".globl math_text\n"
        ".hidden math_text\n"
        ".type math_text, %object\n"
        "math_text:\n"
        ".incbin \"sph/lanes-math.h\"\n"
        ".byte 0\n"
        ".size math_text, . - math_text\n"
        ".popsection\n");
