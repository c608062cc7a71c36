/* registry/elf_image.c -- header, segments and sections of a shared object (see elf_image.h).
 * Segments are what is mapped; the table of sections tells the same a second time, so that a
 * damaged number in one of them shows as a contradiction. */
#include "config.h"

#include "registry/elf_image.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SEGMENTS_MAX 256u
#define SECTIONS_MAX 4096u
#define MAPPED_MAX ((uint64_t)1 << 32)

static bool inside(uint64_t at, uint64_t n, uint64_t size)
{
    return at <= size && n <= size - at;
}

static uint64_t page_down(uint64_t address)
{
    return address & ~((uint64_t)sysconf(_SC_PAGESIZE) - 1);
}

static uint64_t page_up(uint64_t address)
{
    return page_down(address + (uint64_t)sysconf(_SC_PAGESIZE) - 1);
}

int image_damaged(const char *what, struct error *e)
{
    return error_set(e, EXIT_REFUSED, "it is damaged: %s", what);
}

/* -- Where addresses lead -------- */

static const elf_segment *load_of(const struct image *im, uint64_t address, uint64_t n)
{
    for (unsigned i = 0; i < im->n_segment; i++) {
        const elf_segment *s = &im->segment[i];
        if (s->p_type == PT_LOAD && address >= s->p_vaddr &&
            inside(address - s->p_vaddr, n, s->p_memsz))
            return s;
    }
    return NULL;
}

const void *image_at(const struct image *im, uint64_t address, uint64_t n, uint32_t flags)
{
    const elf_segment *s = load_of(im, address, n);

    if (!s || (s->p_flags & flags) != flags || !inside(address - s->p_vaddr, n, s->p_filesz))
        return NULL;
    return im->data + s->p_offset + (address - s->p_vaddr);
}

bool image_has(const struct image *im, uint64_t address, uint64_t n, uint32_t flags)
{
    const elf_segment *s = load_of(im, address, n);

    return s && (s->p_flags & flags) == flags;
}

uint64_t image_end(const struct image *im)
{
    uint64_t end = 0;

    for (unsigned i = 0; i < im->n_segment; i++)
        if (im->segment[i].p_type == PT_LOAD)
            end = im->segment[i].p_vaddr + im->segment[i].p_memsz;
    return end;
}

const elf_section *image_section(const struct image *im, uint64_t address)
{
    for (unsigned i = 0; i < im->n_section; i++) {
        const elf_section *s = &im->section[i];
        if ((s->sh_flags & SHF_ALLOC) && address >= s->sh_addr &&
            address - s->sh_addr < s->sh_size &&
            !(s->sh_type == SHT_NOBITS && (s->sh_flags & SHF_TLS)))
            return s;
    }
    return NULL;
}

bool image_section_begins(const struct image *im, const elf_section *s, const char *text)
{
    const elf_section *names = &im->section[im->header.e_shstrndx];
    const size_t n = strlen(text);

    return im->header.e_shstrndx < im->n_section &&
           inside(names->sh_offset, s->sh_name, im->size) &&
           inside(names->sh_offset + s->sh_name, n, im->size) &&
           memcmp(im->data + names->sh_offset + s->sh_name, text, n) == 0;
}

/* -- Header -------- */

/* The header of this very program says what the machine is. */
static bool own_header(elf_header *out)
{
    const int fd = open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
    const bool ok = fd >= 0 && read(fd, out, sizeof(*out)) == (ssize_t)sizeof(*out);

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

/* -- Segments -------- */

static int check_load(const elf_segment *s, uint64_t *end, struct error *e)
{
    /* What the dynamic linker takes for granted: they rise, share no page, hold their bytes. */
    if (s->p_memsz < s->p_filesz || s->p_vaddr > MAPPED_MAX || s->p_memsz > MAPPED_MAX ||
        page_down(s->p_vaddr) < *end || (s->p_align & (s->p_align - 1)) ||
        s->p_align > MAPPED_MAX || page_down(s->p_vaddr - s->p_offset) != s->p_vaddr - s->p_offset)
        return image_damaged("its segments contradict each other", e);
    if ((s->p_flags & (PF_W | PF_X)) == (PF_W | PF_X))
        return error_set(e, EXIT_REFUSED, "a segment of it can be both written and executed");
    *end = page_up(s->p_vaddr + s->p_memsz);
    return 0;
}

static int read_segments(struct image *im, struct error *e)
{
    const elf_header *h = &im->header;
    uint64_t end = 0;
    unsigned loads = 0, dynamics = 0;

    if (h->e_phentsize != sizeof(elf_segment) || h->e_phnum == 0 || h->e_phnum > SEGMENTS_MAX)
        return image_damaged("its table of segments is odd", e);
    if (!inside(h->e_phoff, (uint64_t)h->e_phnum * sizeof(elf_segment), im->size))
        return error_set(e, EXIT_REFUSED, "it is truncated: its table of segments is missing");
    im->segment = calloc(h->e_phnum, sizeof(*im->segment));
    if (!im->segment)
        return error_memory(e, "a table of segments", h->e_phnum * sizeof(*im->segment));
    memcpy(im->segment, im->data + h->e_phoff, h->e_phnum * sizeof(*im->segment));
    im->n_segment = h->e_phnum;
    for (unsigned i = 0; i < im->n_segment; i++) {
        const elf_segment *s = &im->segment[i];
        if (s->p_type != PT_NULL && s->p_type != PT_GNU_STACK &&
            !inside(s->p_offset, s->p_filesz, im->size))
            return error_set(
                e, EXIT_REFUSED, "it is truncated: a segment ends at byte %llu, the file at %llu",
                (unsigned long long)(s->p_offset + s->p_filesz), (unsigned long long)im->size);
        if (s->p_type == PT_LOAD && check_load(s, &end, e))
            return -1;
        loads += s->p_type == PT_LOAD;
        dynamics += s->p_type == PT_DYNAMIC;
    }
    if (loads == 0 || dynamics != 1)
        return error_set(e, EXIT_REFUSED,
                         "it is damaged: it has %u segments to load and %u dynamic ones", loads,
                         dynamics);
    return 0;
}

/* Is `p`, which may be NULL, this byte of the file? */
static bool comes_from(const struct image *im, uint64_t offset, const unsigned char *p)
{
    return p && (uint64_t)(p - im->data) == offset;
}

/* The bytes of this segment are those that a segment to load brings to its address. */
static bool is_loaded(const struct image *im, const elf_segment *s)
{
    return s->p_filesz == 0 ||
           comes_from(im, s->p_offset, image_at(im, s->p_vaddr, s->p_filesz, PF_R));
}

/* The part that is made read-only after relocation must not reach into what is written later. */
static bool is_relro_right(const struct image *im, const elf_segment *s)
{
    const elf_segment *load = load_of(im, s->p_vaddr, 0);
    const uint64_t end = page_down(s->p_vaddr + s->p_memsz);

    if (!load || !(load->p_flags & PF_W) || s->p_memsz > MAPPED_MAX ||
        s->p_vaddr + s->p_memsz > page_up(load->p_vaddr + load->p_memsz))
        return false;
    for (unsigned i = 0; i < im->n_section; i++) {
        const elf_section *x = &im->section[i];
        const bool zeroed = x->sh_type == SHT_NOBITS && x->sh_size > 0;
        if (!(x->sh_flags & SHF_ALLOC) || (zeroed && (x->sh_flags & SHF_TLS)) ||
            x->sh_addr < s->p_vaddr || x->sh_addr >= end)
            continue;
        /* Where functions are bound late the head alone of their table is in it. */
        if (zeroed || (x->sh_addr + x->sh_size > end && !image_section_begins(im, x, ".got")))
            return false;
    }
    return im->n_section == 0 || image_section(im, s->p_vaddr);
}

static int check_segment(const struct image *im, const elf_segment *s, struct error *e)
{
    bool good = true;

    switch (s->p_type) {
    case PT_PHDR:
        good = is_loaded(im, s) && s->p_offset == im->header.e_phoff;
        break;
    case PT_DYNAMIC: /* the linker writes into it, unless it says that it must not */
        good =
            is_loaded(im, s) && image_has(im, s->p_vaddr, s->p_filesz, PF_R | (s->p_flags & PF_W));
        break;
    case PT_TLS:
        good = is_loaded(im, s) && s->p_memsz >= s->p_filesz && s->p_memsz < (1u << 24) &&
               (s->p_align & (s->p_align - 1)) == 0 && s->p_align <= 65536;
        break;
    case PT_NOTE:
    case PT_GNU_EH_FRAME:
    case PT_GNU_PROPERTY:
        good = is_loaded(im, s);
        break;
    case PT_GNU_RELRO:
        good = is_relro_right(im, s);
        break;
    default:
        break;
    }
    return good ? 0 : image_damaged("a segment is not where it says", e);
}

static int check_segments(const struct image *im, struct error *e)
{
    const elf_segment *stack = NULL;

    for (unsigned i = 0; i < im->n_segment; i++) {
        if (check_segment(im, &im->segment[i], e))
            return -1;
        if (im->segment[i].p_type == PT_GNU_STACK)
            stack = &im->segment[i];
    }
    if (!stack || (stack->p_flags & PF_X))
        return error_set(e, EXIT_REFUSED,
                         "loading it would make the stack of the program executable: link it with "
                         "-z noexecstack");
    return 0;
}

/* -- Sections -------- */

/* The table of sections stands at the end: it is what a cut file lacks first. */
static int read_sections(struct image *im, struct error *e)
{
    const elf_header *h = &im->header;
    const uint64_t bytes = (uint64_t)h->e_shnum * h->e_shentsize;

    if (h->e_shoff == 0)
        return 0;
    if (!inside(h->e_shoff, bytes, im->size))
        return error_set(e, EXIT_REFUSED,
                         "it is truncated: its table of sections ends at byte %llu, the file at "
                         "%llu",
                         (unsigned long long)h->e_shoff + (unsigned long long)bytes,
                         (unsigned long long)im->size);
    if (h->e_shentsize != sizeof(elf_section) || h->e_shnum == 0 || h->e_shnum > SECTIONS_MAX)
        return image_damaged("its table of sections is odd", e);
    im->section = calloc(h->e_shnum, sizeof(*im->section));
    if (!im->section)
        return error_memory(e, "a table of sections", bytes);
    memcpy(im->section, im->data + h->e_shoff, bytes);
    im->n_section = h->e_shnum;
    return 0;
}

/* Every section that is to be in memory lies in a segment that brings it there, with its rights. */
static bool is_section_right(const struct image *im, const elf_section *s)
{
    const elf_segment *load;
    uint32_t flags = PF_R;

    if (!(s->sh_flags & SHF_ALLOC) || s->sh_size == 0 ||
        (s->sh_type == SHT_NOBITS && (s->sh_flags & SHF_TLS)))
        return true;
    load = load_of(im, s->sh_addr, s->sh_size);
    if (s->sh_flags & SHF_WRITE)
        flags |= PF_W;
    if (s->sh_flags & SHF_EXECINSTR)
        flags |= PF_X;
    if (!load || (load->p_flags & flags) != flags)
        return false;
    if (s->sh_type == SHT_NOBITS)
        return s->sh_addr >= load->p_vaddr + load->p_filesz;
    return comes_from(im, s->sh_offset, image_at(im, s->sh_addr, s->sh_size, PF_R));
}

static int check_sections(const struct image *im, struct error *e)
{
    for (unsigned i = 0; i < im->n_section; i++)
        if (!is_section_right(im, &im->section[i]))
            return image_damaged("its sections and its segments contradict each other", e);
    return 0;
}

/* -- The file -------- */

static int read_all(struct image *im, int fd, uint64_t size, struct error *e)
{
    uint64_t done = 0;

    if (size == 0)
        return error_set(e, EXIT_REFUSED, "it is empty");
    if (size > MAPPED_MAX)
        return error_set(e, EXIT_REFUSED, "its %llu bytes are more than a plugin may have (%llu)",
                         (unsigned long long)size, (unsigned long long)MAPPED_MAX);
    im->data = malloc((size_t)size);
    if (!im->data)
        return error_memory(e, "a plugin's file", size);
    while (done < size) {
        const ssize_t n = pread(fd, im->data + done, (size_t)(size - done), (off_t)done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return error_set(e, EXIT_REFUSED, "it cannot be read: %s", strerror(errno));
        if (n == 0)
            return error_set(e, EXIT_REFUSED, "it became shorter while it was read");
        done += (uint64_t)n;
    }
    im->size = size;
    return 0;
}

int image_init(struct image *im, int fd, uint64_t size, struct error *e)
{
    memset(im, 0, sizeof(*im));
    if (read_all(im, fd, size, e))
        return -1;
    memcpy(&im->header, im->data, size < sizeof(im->header) ? (size_t)size : sizeof(im->header));
    if (size < sizeof(im->header) && memcmp(im->header.e_ident, ELFMAG, SELFMAG) == 0)
        return error_set(e, EXIT_REFUSED, "it is truncated: it ends within its header");
    if (check_header(&im->header, e) || read_segments(im, e) || read_sections(im, e))
        return -1;
    return check_sections(im, e) ? -1 : check_segments(im, e);
}

void image_fini(struct image *im)
{
    free(im->data);
    free(im->segment);
    free(im->section);
    free(im->dynamic);
    memset(im, 0, sizeof(*im));
}
