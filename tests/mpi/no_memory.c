/* no_memory.c -- memory that is refused: in front of the C library by LD_PRELOAD. Of the calls of malloc, calloc and
 * realloc that the program itself makes, not its libraries, those from the number in SPH_NO_MEMORY on fail, SPH_FEW of
 * them (1). At the end it tells in the file SPH_MEMORY_CALLS how many there were. */
#include "config.h"

#include <link.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#pragma GCC visibility push(default)
void *malloc(size_t size);
void *calloc(size_t n, size_t size);
void *realloc(void *old, size_t size);
#pragma GCC visibility pop

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_realloc(void *old, size_t size);

static uintptr_t first, end; /* of the program in memory */
static long from, few;
static atomic_long calls;

/* The first object is the program. */
static int find(struct dl_phdr_info *info, size_t size, void *data)
{
    (void)size;
    (void)data;
    for (int k = 0; k < info->dlpi_phnum; k++) {
        const ElfW(Phdr) *h = &info->dlpi_phdr[k];
        if (h->p_type != PT_LOAD)
            continue;
        const uintptr_t at = info->dlpi_addr + h->p_vaddr;
        if (!end || at < first)
            first = at;
        if (at + h->p_memsz > end)
            end = at + h->p_memsz;
    }
    return 1;
}

__attribute__((constructor)) static void begin(void)
{
    const char *number = getenv("SPH_NO_MEMORY"), *many = getenv("SPH_FEW");
    from = number ? strtol(number, NULL, 10) : 0;
    few = many ? strtol(many, NULL, 10) : 1;
    dl_iterate_phdr(find, NULL);
}

__attribute__((destructor)) static void tell(void)
{
    const char *name = getenv("SPH_MEMORY_CALLS");
    FILE *file = name ? fopen(name, "w") : NULL;
    if (!file)
        return;
    fprintf(file, "%ld\n", atomic_load(&calls));
    fclose(file);
}

static bool refused(const void *caller)
{
    const uintptr_t at = (uintptr_t)caller;
    if (at < first || at >= end)
        return false;
    const long n = atomic_fetch_add(&calls, 1) + 1;
    return from > 0 && n >= from && n < from + few;
}

void *malloc(size_t size)
{
    return refused(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    return refused(__builtin_return_address(0)) ? NULL : __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
    return refused(__builtin_return_address(0)) ? NULL : __libc_realloc(old, size);
}
