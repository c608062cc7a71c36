/* registry/elf_dynamic.c -- the dynamic section of a shared object (see elf_image.h): the
 * dynamic linker follows its addresses and sizes without a look, and asserts on some of them. */
#include "config.h"

#include "registry/elf_image.h"

#include <stdlib.h>
#include <string.h>

#define DYNAMIC_MAX 512u

bool image_tag(const struct image *im, int64_t tag, uint64_t *value)
{
    for (unsigned i = 0; i < im->n_dynamic; i++) {
        if ((int64_t)im->dynamic[i].d_tag != tag)
            continue;
        *value = im->dynamic[i].d_un.d_val;
        return true;
    }
    return false;
}

static bool may_repeat(int64_t tag)
{
    return tag == DT_NEEDED || tag == DT_AUXILIARY || tag == DT_FILTER;
}

static int read_dynamic(struct image *im, struct error *e)
{
    const elf_segment *s = im->segment;
    uint64_t n;

    while (s->p_type != PT_DYNAMIC)
        s++;
    n = s->p_filesz / sizeof(elf_dynamic);
    if (n == 0 || n > DYNAMIC_MAX || s->p_vaddr % sizeof(void *) != 0)
        return image_damaged("its dynamic section is odd", e);
    im->dynamic = calloc(n, sizeof(*im->dynamic));
    if (!im->dynamic)
        return error_memory(e, "a dynamic section", n * sizeof(*im->dynamic));
    memcpy(im->dynamic, im->data + s->p_offset, n * sizeof(*im->dynamic));
    while (im->n_dynamic < n && im->dynamic[im->n_dynamic].d_tag != DT_NULL)
        im->n_dynamic++;
    if (im->n_dynamic == n)
        return image_damaged("its dynamic section does not end", e);
    /* More behind the end is what the end should not have cut off. */
    for (uint64_t i = im->n_dynamic; i < n; i++)
        if (im->dynamic[i].d_tag != DT_NULL)
            return image_damaged("its dynamic section goes on behind its end", e);
    for (unsigned i = 0; i < im->n_dynamic; i++)
        for (unsigned k = 0; k < i; k++)
            if (im->dynamic[i].d_tag == im->dynamic[k].d_tag && !may_repeat(im->dynamic[i].d_tag))
                return image_damaged("its dynamic section says something twice", e);
    return 0;
}

static int check_strings(struct image *im, struct error *e)
{
    static const int64_t names[] = {DT_NEEDED, DT_SONAME, DT_RPATH,    DT_RUNPATH, DT_AUXILIARY,
                                    DT_FILTER, DT_AUDIT,  DT_DEPAUDIT, DT_CONFIG};
    uint64_t at = 0;

    if (!image_tag(im, DT_STRTAB, &at) || !image_tag(im, DT_STRSZ, &im->n_string) ||
        im->n_string == 0)
        return image_damaged("it has no dynamic strings", e);
    im->strings = image_at(im, at, im->n_string, PF_R);
    if (!im->strings || im->strings[im->n_string - 1] != '\0')
        return image_damaged("its dynamic strings are not where it says", e);
    for (unsigned i = 0; i < im->n_dynamic; i++)
        for (size_t k = 0; k < sizeof(names) / sizeof(names[0]); k++)
            if ((int64_t)im->dynamic[i].d_tag == names[k] &&
                im->dynamic[i].d_un.d_val >= im->n_string)
                return image_damaged("its dynamic section names what is not in its strings", e);
    return 0;
}

/* Tags that go together, and the sizes of entries, on which the dynamic linker asserts. */
static int check_sizes(const struct image *im, struct error *e)
{
    static const struct {
        int64_t address, size, entry;
        uint64_t bytes;
    } table[] = {{DT_RELA, DT_RELASZ, DT_RELAENT, sizeof(ElfW(Rela))},
                 {DT_REL, DT_RELSZ, DT_RELENT, sizeof(ElfW(Rel))},
                 {DT_RELR, DT_RELRSZ, DT_RELRENT, sizeof(ElfW(Addr))}};
    uint64_t value = 0, size = 0;

    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
        const bool has = image_tag(im, table[i].address, &value);
        if (has != image_tag(im, table[i].size, &size) ||
            has != image_tag(im, table[i].entry, &value) ||
            (has && (value != table[i].bytes || size % table[i].bytes != 0)))
            return image_damaged("its tables of relocations are odd", e);
    }
    if (!image_tag(im, DT_SYMENT, &value) || value != sizeof(elf_symbol))
        return image_damaged("its symbols are of an odd size", e);
    if (image_tag(im, DT_JMPREL, &value) != image_tag(im, DT_PLTRELSZ, &value) ||
        image_tag(im, DT_JMPREL, &value) != image_tag(im, DT_PLTREL, &value))
        return image_damaged("its tables of relocations are odd", e);
    if (image_tag(im, DT_PLTREL, &value) && value != (sizeof(void *) == 8 ? DT_RELA : DT_REL) &&
        !(sizeof(void *) == 4 && value == DT_RELA))
        return image_damaged("its tables of relocations are odd", e);
    if (image_tag(im, DT_PLTGOT, &value) && !image_has(im, value, sizeof(void *), PF_R))
        return image_damaged("its table of addresses is not where it says", e);
    return 0;
}

static int check_flags(const struct image *im, struct error *e)
{
    uint64_t flags = 0, value = 0;

    image_tag(im, DT_FLAGS, &flags);
    if ((flags & DF_TEXTREL) || image_tag(im, DT_TEXTREL, &value))
        return error_set(e, EXIT_REFUSED,
                         "loading it would change its code: compile it with -fPIC");
    return 0;
}

/* -- The sections' second opinion -------- */

/* Types of sections that the dynamic section must point to, and where it says so. */
static const struct {
    uint32_t type;
    int64_t address, size;
} twin[] = {
    {SHT_DYNSYM, DT_SYMTAB, 0},
    {SHT_HASH, DT_HASH, 0},
    {SHT_GNU_HASH, DT_GNU_HASH, 0},
    {SHT_GNU_versym, DT_VERSYM, 0},
    {SHT_GNU_verneed, DT_VERNEED, 0},
    {SHT_GNU_verdef, DT_VERDEF, 0},
    {SHT_INIT_ARRAY, DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
    {SHT_FINI_ARRAY, DT_FINI_ARRAY, DT_FINI_ARRAYSZ},
};

/* Is this section of relocations within one of the tables? */
static bool is_relocated(const struct image *im, const elf_section *s)
{
    static const int64_t table[][2] = {
        {DT_RELA, DT_RELASZ}, {DT_REL, DT_RELSZ}, {DT_JMPREL, DT_PLTRELSZ}};
    uint64_t at = 0, n = 0;

    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
        if (image_tag(im, table[i][0], &at) && image_tag(im, table[i][1], &n) && s->sh_addr >= at &&
            s->sh_addr - at < n && s->sh_size <= n - (s->sh_addr - at))
            return true;
    return false;
}

static bool is_twin_right(const struct image *im, const elf_section *s)
{
    uint64_t value = 0;

    if (s->sh_type == SHT_REL || s->sh_type == SHT_RELA)
        return is_relocated(im, s);
    for (size_t i = 0; i < sizeof(twin) / sizeof(twin[0]); i++) {
        if (s->sh_type != twin[i].type)
            continue;
        if (!image_tag(im, twin[i].address, &value) || value != s->sh_addr)
            return false;
        if (twin[i].size && (!image_tag(im, twin[i].size, &value) || value != s->sh_size))
            return false;
        /* Its strings are those that the dynamic section has. */
        if (s->sh_type == SHT_DYNSYM && s->sh_link < im->n_section &&
            (!image_tag(im, DT_STRTAB, &value) || value != im->section[s->sh_link].sh_addr ||
             im->section[s->sh_link].sh_size != im->n_string))
            return false;
    }
    return true;
}

/* Code that runs on loading and closing is a section of its own, of that name. */
static bool is_section_of_code(const struct image *im, int64_t tag, const char *name)
{
    const elf_section *s;
    uint64_t address = 0;

    if (!image_tag(im, tag, &address))
        return true;
    if (!image_has(im, address, 1, PF_X))
        return false;
    s = image_section(im, address);
    return im->n_section == 0 || (s && s->sh_addr == address && (s->sh_flags & SHF_EXECINSTR) &&
                                  image_section_begins(im, s, name));
}

/* The other way round: a table that is said to be somewhere is a section there. */
static bool has_section(const struct image *im, size_t i)
{
    const elf_section *s;
    uint64_t address = 0;

    if (!image_tag(im, twin[i].address, &address))
        return true;
    s = image_section(im, address);
    return s && s->sh_addr == address && s->sh_type == twin[i].type;
}

static int check_twins(const struct image *im, struct error *e)
{
    bool good = true;

    if (!is_section_of_code(im, DT_INIT, ".init") || !is_section_of_code(im, DT_FINI, ".fini"))
        return error_set(e, EXIT_REFUSED,
                         "what it runs on loading or closing (DT_INIT, DT_FINI) is not its section "
                         ".init or .fini: link it without -Wl,-init and -Wl,-fini");
    for (unsigned i = 0; i < im->n_section; i++)
        if ((im->section[i].sh_flags & SHF_ALLOC) && im->section[i].sh_size > 0)
            good = good && is_twin_right(im, &im->section[i]);
    for (size_t i = 0; im->n_section > 0 && i < sizeof(twin) / sizeof(twin[0]); i++)
        good = good && has_section(im, i);
    return good ? 0
                : image_damaged("its sections and its dynamic section contradict each other", e);
}

int image_check_dynamic(struct image *im, struct error *e)
{
    if (read_dynamic(im, e) || check_strings(im, e) || check_sizes(im, e) || check_flags(im, e))
        return -1;
    return check_twins(im, e);
}
