/* opencl/search_text.h -- the OpenCL C of neighbour lists and of order: the texts of the .cl files
 * beside it. */
#ifndef OPENCL_SEARCH_TEXT_H
#define OPENCL_SEARCH_TEXT_H

#include "opencl/embed.h"

#define TEXT extern EMBEDDED /* each ends with NUL */

TEXT sort_text[];
TEXT points_text[];
TEXT survey_text[];
TEXT search_text[];
TEXT lists_text[];
TEXT bundles_text[];
TEXT order_text[];
TEXT own_order_text[];
TEXT crowds_text[];

#undef TEXT

#endif
