/* opencl/ops_text.c -- embeds the kernels of ops*.cl by the assembler, as math_text.c does a header. */
#include "config.h"

#include "opencl/ops_private.h"

#define EMBED(name)                                                                                \
    __asm__(".pushsection .rodata\n"                                                               \
            ".globl " #name "_text\n"                                                              \
            ".hidden " #name "_text\n"                                                             \
            ".type " #name "_text, %object\n" #name "_text:\n"                                     \
            ".incbin \"opencl/" #name ".cl\"\n"                                                    \
            ".byte 0\n"                                                                            \
            ".size " #name "_text, . - " #name "_text\n"                                           \
            ".popsection\n")

EMBED(ops_words);
EMBED(ops_lanes);
EMBED(ops_columns);
EMBED(ops_reduce);
EMBED(ops_sides);
