/* registry/reach.c -- asks the kernel whether an address can be read (see reach.h): it copies a
 * byte from the address and fails where a read of ours would be the end. */
#include "config.h"

#include "registry/reach.h"

#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

/* Where the call is forbidden, as in some sandboxes, every address passes. */
static bool is_there(const void *p)
{
    char byte;
    const struct iovec here = {&byte, 1}, there = {(void *)p, 1};

    return process_vm_readv(getpid(), &here, 1, &there, 1, 0) == 1 || errno != EFAULT;
}

/* Bytes from p to the end of its page. */
static size_t left(const char *p)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);

    return page - (uintptr_t)p % page;
}

bool reach_bytes(const void *p, size_t n)
{
    const char *at = p;

    if (n > UINTPTR_MAX - (uintptr_t)p)
        return false;
    while (n > 0) {
        const size_t part = left(at) < n ? left(at) : n;
        if (!is_there(at))
            return false;
        at += part;
        n -= part;
    }
    return true;
}

bool reach_text(const char *s, size_t most)
{
    while (s && most > 0) {
        const size_t part = left(s) < most ? left(s) : most;
        if (!is_there(s))
            return false;
        if (memchr(s, '\0', part))
            return true;
        s += part;
        most -= part;
    }
    return s != NULL;
}
