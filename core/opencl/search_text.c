/* opencl/search_text.c -- embeds them by the assembler, as math_text.c does its header, where it is
 * said why. */
#include "config.h"

#include "opencl/search_text.h"

#define EMBED(name, file)                                                                          \
    __asm__(".pushsection .rodata\n"                                                               \
            ".globl " name "\n"                                                                    \
            ".hidden " name "\n"                                                                   \
            ".type " name ", %object\n" name ":\n"                                                 \
            ".incbin \"opencl/" file "\"\n"                                                        \
            ".byte 0\n"                                                                            \
            ".size " name ", . - " name "\n"                                                       \
            ".popsection\n")

EMBED("sort_text", "sort.cl");
EMBED("points_text", "points.cl");
EMBED("search_text", "search.cl");
EMBED("lists_text", "lists.cl");
EMBED("bundles_text", "bundles.cl");
EMBED("order_text", "order.cl");
