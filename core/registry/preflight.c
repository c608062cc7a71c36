/* registry/preflight.c -- looks at a plugin's file before it is mapped (see preflight.h): the
 * dynamic linker trusts what it maps, and a truncated or damaged file ends the program in the
 * midst of it. */
#include "config.h"

#include "registry/preflight.h"

#include "registry/elf_image.h"
#include "registry/trust.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static int check_content(int fd, uint64_t size, struct error *e)
{
    struct image image;
    int status = image_init(&image, fd, size, e);

    if (!status)
        status = image_check_dynamic(&image, e);
    if (!status)
        status = image_check_symbols(&image, PREFLIGHT_ENTRY, e);
    if (!status)
        status = image_check_relocations(&image, e);
    image_fini(&image);
    return status;
}

int preflight_open(const char *path, struct stat *st, struct error *e)
{
    /* O_NONBLOCK: a FIFO of that name shall not hang us. */
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | O_NOFOLLOW);
    int status;

    if (fd < 0)
        return error_set(e, EXIT_REFUSED, "it cannot be opened: %s", strerror(errno));
    if (fstat(fd, st))
        status = error_set(e, EXIT_REFUSED, "it cannot be looked at: %s", strerror(errno));
    else
        status = trust_file(st, e) ? -1 : check_content(fd, (uint64_t)st->st_size, e);
    if (!status)
        return fd;
    close(fd);
    return -1;
}

int preflight_file(const char *path, struct error *e)
{
    struct stat st;
    const int fd = preflight_open(path, &st, e);

    if (fd >= 0)
        close(fd);
    return fd < 0 ? -1 : 0;
}
