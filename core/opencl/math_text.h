/* opencl/math_text.h -- the text of sph/lanes-math.h: exp, log and pow for devices are those of the
 * native loops. */
#ifndef OPENCL_MATH_TEXT_H
#define OPENCL_MATH_TEXT_H

extern __attribute__((visibility("hidden"))) const char math_text[]; /* ends with NUL */

#endif
