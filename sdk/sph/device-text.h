/* sph/device-text.h -- a body's file as a string in the plugin, for devices; the inside of pair-device.h and
 * point-device.h. */
#ifndef SPH_DEVICE_TEXT_H
#define SPH_DEVICE_TEXT_H

#if !defined(__ELF__)
#error                                                                                             \
    "SPH_LOOP_DEVICE and SPH_POINT_DEVICE embed a file by the assembler's .incbin, written here for ELF"
#endif

/* The text of a file as a string. The symbol is hidden, and global all the same: link time
 * optimisation puts the assembler's text and the code that reads it into different objects. */
#define SPH_DEVICE_WORDS(a) #a
#define SPH_DEVICE_SYMBOL(a) SPH_DEVICE_WORDS(a)
#define SPH_DEVICE_INCBIN(file) ".incbin \"" file "\"\n"
#define SPH_DEVICE_EMBED(symbol, name, texts)                                                      \
    __asm__(".pushsection .rodata\n"                                                               \
            ".globl " name "\n"                                                                    \
            ".hidden " name "\n"                                                                   \
            ".type " name ", %object\n" name ":\n" texts ".byte 0\n"                               \
            ".size " name ", . - " name "\n"                                                       \
            ".popsection\n");                                                                      \
    extern __attribute__((visibility("hidden"))) const char symbol[]

#endif
