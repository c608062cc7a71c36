/* no_sync.c -- a disk that fails: in front of the C library by LD_PRELOAD. Call number SPH_NO_SYNC of fsync fails. */
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_long calls;

#pragma GCC visibility push(default)
int fsync(int file);
#pragma GCC visibility pop

int fsync(int file)
{
    const char *number = getenv("SPH_NO_SYNC");
    if (number && atomic_fetch_add(&calls, 1) + 1 == strtol(number, NULL, 10)) {
        errno = EIO;
        return -1;
    }
    return (int)syscall(SYS_fsync, file);
}
