/* opencl/device_log.h -- what a driver's compiler complains of, and where in the source that is. Knows
 * texts alone. */
#ifndef OPENCL_DEVICE_LOG_H
#define OPENCL_DEVICE_LOG_H

#include <stdbool.h>

struct device_complaint {
    char file[256]; /* as `#line` names it; "": of none, the line counts from the source's begin */
    unsigned long line; /* 0: the driver does not say */
    char message[512];
};

/* The first error in the log of a build of `text`. false: there is none. */
bool device_log_read(const char *text, const char *log, struct device_complaint *out);

#endif
