/* opencl/search_text.c -- embeds the texts of the search (see embed.h). */
#include "config.h"

#include "opencl/embed.h"
#include "opencl/search_text.h"

EMBED("sort_text", "opencl/sort.cl");
EMBED("points_text", "opencl/points.cl");
EMBED("survey_text", "opencl/survey.cl");
EMBED("search_text", "opencl/search.cl");
EMBED("lists_text", "opencl/lists.cl");
EMBED("bundles_text", "opencl/bundles.cl");
EMBED("order_text", "opencl/order.cl");
EMBED("own_order_text", "opencl/own_order.cl");
EMBED("crowds_text", "opencl/crowds.cl");
