/* opencl/ops_text.c -- embeds the kernels of ops*.cl (see embed.h). */
#include "config.h"

#include "opencl/embed.h"
#include "opencl/ops_private.h"

EMBED("ops_words_text", "opencl/ops_words.cl");
EMBED("ops_lanes_text", "opencl/ops_lanes.cl");
EMBED("ops_columns_text", "opencl/ops_columns.cl");
EMBED("ops_reduce_text", "opencl/ops_reduce.cl");
EMBED("ops_sides_text", "opencl/ops_sides.cl");
