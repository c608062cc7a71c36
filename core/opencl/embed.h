/* opencl/embed.h -- the text of a file as a string, put there by the assembler, as the SDK does with bodies. Global
 * and hidden, for link time optimisation puts what the assembler makes and what reads it into different
 * objects. core/fragment.am says what such a file is made from: no compiler would. */
#ifndef OPENCL_EMBED_H
#define OPENCL_EMBED_H

/* EMBED("look_text", "opencl/look.cl"); declared by its users: extern EMBEDDED look_text[]. Ends with NUL. */
#define EMBED(name, file)                                                                          \
    __asm__(".pushsection .rodata\n"                                                               \
            ".globl " name "\n"                                                                    \
            ".hidden " name "\n"                                                                   \
            ".type " name ", %object\n" name ":\n"                                                 \
            ".incbin \"" file "\"\n"                                                               \
            ".byte 0\n"                                                                            \
            ".size " name ", . - " name "\n"                                                       \
            ".popsection\n")
#define EMBEDDED __attribute__((visibility("hidden"))) const char

#endif
