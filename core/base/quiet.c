/* base/quiet.c -- silences a library (see quiet.h). */
#include "config.h"

#include "base/quiet.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

void quiet_begin(int kept[2])
{
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);

    fflush(stdout);
    for (int k = 0; k < 2; k++) {
        kept[k] = nowhere < 0 ? -1 : fcntl(STDOUT_FILENO + k, F_DUPFD_CLOEXEC, 3);
        if (kept[k] >= 0)
            dup2(nowhere, STDOUT_FILENO + k);
    }
    if (nowhere >= 0)
        close(nowhere);
}

void quiet_end(const int kept[2])
{
    fflush(stdout);
    for (int k = 0; k < 2; k++)
        if (kept[k] >= 0) {
            dup2(kept[k], STDOUT_FILENO + k);
            close(kept[k]);
        }
}
