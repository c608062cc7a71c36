/* registry/preflight.c -- looks at a plugin's file before it is mapped: the dynamic linker trusts
 * what it maps, and a truncated file ends in SIGBUS. Reads the file and its folder's mode, nothing
 * else. */
#include "config.h"

#include "registry/preflight.h"

#include <elf.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <link.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef ElfW(Ehdr) elf_header;
typedef ElfW(Phdr) elf_segment;

#define SEGMENTS_MAX 256u
#define MAPPED_MAX ((uint64_t)1 << 32)

static int check_file_mode(const struct stat *st, struct error *e)
{
    if (!S_ISREG(st->st_mode))
        return error_set(e, EXIT_REFUSED, "it is not a regular file");
    if (st->st_mode & (S_IWGRP | S_IWOTH))
        return error_set(e, EXIT_REFUSED, "others may write to the file (mode %03o; chmod go-w)",
                         (unsigned)st->st_mode & 0777u);
    return 0;
}

/* In a sticky folder (/tmp) others may add files, but not replace this one. */
static int check_folder_mode(const char *path, struct error *e)
{
    struct stat st;
    char *copy = strdup(path);
    int failed;

    if (!copy)
        return error_memory(e, "a path", strlen(path));
    failed = stat(dirname(copy), &st);
    free(copy);
    if (failed)
        return error_set(e, EXIT_REFUSED, "its folder cannot be looked at: %s", strerror(errno));
    if ((st.st_mode & S_IWOTH) && !(st.st_mode & S_ISVTX))
        return error_set(e, EXIT_REFUSED, "others may write to its folder (mode %03o; chmod o-w)",
                         (unsigned)st.st_mode & 0777u);
    return 0;
}

/* All of it, or an error: a short file is a truncated one. */
static int read_at(int fd, void *out, size_t n, uint64_t at)
{
    size_t done = 0;

    while (done < n) {
        const ssize_t k = pread(fd, (char *)out + done, n - done, (off_t)(at + done));
        if (k < 0 && errno == EINTR)
            continue;
        if (k <= 0)
            return -1;
        done += (size_t)k;
    }
    return 0;
}

/* The header of this very program says what the machine is. */
static bool own_header(elf_header *out)
{
    const int fd = open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
    const bool ok = fd >= 0 && read_at(fd, out, sizeof(*out), 0) == 0;

    if (fd >= 0)
        close(fd);
    return ok;
}

static const char *machine_name(unsigned machine)
{
    static const struct {
        unsigned machine;
        const char *name;
    } known[] = {{EM_386, "32-bit x86"}, {EM_X86_64, "x86-64"},  {EM_ARM, "32-bit ARM"},
                 {EM_AARCH64, "ARM 64"}, {EM_PPC64, "POWER 64"}, {EM_S390, "S/390"},
                 {EM_RISCV, "RISC-V"},   {EM_MIPS, "MIPS"},      {EM_SPARCV9, "SPARC 64"}};

    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
        if (known[i].machine == machine)
            return known[i].name;
    return "a machine of another kind";
}

static int check_header(const elf_header *h, struct error *e)
{
    elf_header own;

    if (memcmp(h->e_ident, ELFMAG, SELFMAG) != 0)
        return error_set(e, EXIT_REFUSED, "it is not an ELF file, so not a plugin");
    if (h->e_ident[EI_CLASS] != (sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32))
        return error_set(e, EXIT_REFUSED, "it was built for %d-bit machines, this sph for %zu-bit",
                         h->e_ident[EI_CLASS] == ELFCLASS64 ? 64 : 32, sizeof(void *) * 8);
    if (own_header(&own)) {
        if (h->e_ident[EI_DATA] != own.e_ident[EI_DATA])
            return error_set(e, EXIT_REFUSED, "it was built for another byte order");
        if (h->e_machine != own.e_machine)
            return error_set(e, EXIT_REFUSED, "it was built for %s (%u), this sph for %s (%u)",
                             machine_name(h->e_machine), h->e_machine, machine_name(own.e_machine),
                             own.e_machine);
    }
    if (h->e_version != EV_CURRENT || h->e_ident[EI_VERSION] != EV_CURRENT)
        return error_set(e, EXIT_REFUSED, "its ELF version is %u, not %d", h->e_version,
                         EV_CURRENT);
    if (h->e_type != ET_DYN)
        return error_set(e, EXIT_REFUSED, "it is not a shared object (ELF type %u)", h->e_type);
    return 0;
}

static bool inside(uint64_t at, uint64_t n, uint64_t size)
{
    return at <= size && n <= size - at;
}

static int check_segment(const elf_segment *s, uint64_t size, uint64_t *end, struct error *e)
{
    if (s->p_type != PT_NULL && s->p_type != PT_GNU_STACK &&
        !inside(s->p_offset, s->p_filesz, size))
        return error_set(e, EXIT_REFUSED,
                         "it is truncated: a segment ends at byte %llu, the file "
                         "at %llu",
                         (unsigned long long)(s->p_offset + s->p_filesz), (unsigned long long)size);
    if (s->p_type != PT_LOAD)
        return 0;
    /* What the dynamic linker takes for granted: they rise, do not overlap, hold their bytes. */
    if (s->p_memsz < s->p_filesz || s->p_vaddr < *end || s->p_vaddr > MAPPED_MAX ||
        s->p_memsz > MAPPED_MAX || (s->p_align & (s->p_align - 1)))
        return error_set(e, EXIT_REFUSED, "it is damaged: its segments contradict each other");
    *end = s->p_vaddr + s->p_memsz;
    return 0;
}

static int check_segments(int fd, const elf_header *h, uint64_t size, struct error *e)
{
    elf_segment segment;
    uint64_t end = 0;
    unsigned loads = 0;
    unsigned dynamics = 0;

    if (h->e_phentsize != sizeof(segment) || h->e_phnum == 0 || h->e_phnum > SEGMENTS_MAX)
        return error_set(e, EXIT_REFUSED, "it is damaged: its table of segments is odd");
    if (!inside(h->e_phoff, (uint64_t)h->e_phnum * sizeof(segment), size))
        return error_set(e, EXIT_REFUSED, "it is truncated: its table of segments is missing");
    for (unsigned i = 0; i < h->e_phnum; i++) {
        if (read_at(fd, &segment, sizeof(segment), h->e_phoff + i * sizeof(segment)))
            return error_set(e, EXIT_REFUSED, "it cannot be read: %s", strerror(errno));
        if (check_segment(&segment, size, &end, e))
            return -1;
        loads += segment.p_type == PT_LOAD;
        dynamics += segment.p_type == PT_DYNAMIC;
    }
    if (loads == 0 || dynamics != 1)
        return error_set(e, EXIT_REFUSED,
                         "it is damaged: it has %u segments to load and %u dynamic "
                         "ones",
                         loads, dynamics);
    return 0;
}

/* The table of sections stands at the end: it is what a cut file lacks first. */
static int check_sections(const elf_header *h, uint64_t size, struct error *e)
{
    if (h->e_shoff == 0)
        return 0;
    if (!inside(h->e_shoff, (uint64_t)h->e_shnum * h->e_shentsize, size))
        return error_set(e, EXIT_REFUSED,
                         "it is truncated: its table of sections ends at byte "
                         "%llu, the file at %llu",
                         (unsigned long long)h->e_shoff +
                             (unsigned long long)h->e_shnum * h->e_shentsize,
                         (unsigned long long)size);
    return 0;
}

static int check_elf(int fd, uint64_t size, struct error *e)
{
    elf_header h;

    memset(&h, 0, sizeof(h));
    if (read_at(fd, &h, size < sizeof(h) ? (size_t)size : sizeof(h), 0))
        return error_set(e, EXIT_REFUSED, "it cannot be read: %s", strerror(errno));
    if (size == 0)
        return error_set(e, EXIT_REFUSED, "it is empty");
    if (size < sizeof(h) && memcmp(h.e_ident, ELFMAG, SELFMAG) == 0)
        return error_set(e, EXIT_REFUSED, "it is truncated: it ends within its header");
    if (check_header(&h, e) || check_segments(fd, &h, size, e))
        return -1;
    return check_sections(&h, size, e);
}

int preflight_file(const char *path, struct error *e)
{
    struct stat st;
    /* O_NONBLOCK: a FIFO of that name shall not hang us. */
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    int status = -1;

    if (fd < 0)
        return error_set(e, EXIT_REFUSED, "it cannot be opened: %s", strerror(errno));
    if (fstat(fd, &st))
        error_set(e, EXIT_REFUSED, "it cannot be looked at: %s", strerror(errno));
    else if (!check_file_mode(&st, e) && !check_folder_mode(path, e))
        status = check_elf(fd, (uint64_t)st.st_size, e);
    close(fd);
    return status;
}
