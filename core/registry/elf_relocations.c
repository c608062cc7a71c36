/* registry/elf_relocations.c -- relocations of a shared object (see elf_image.h): the dynamic
 * linker writes where they say. And the lists of functions that run as it is loaded and closed,
 * which it calls without a look: each must be relocated to an address of code. */
#include "config.h"

#include "registry/elf_image.h"

#include <stdlib.h>
#include <string.h>

#define WORD sizeof(ElfW(Addr))
#define USED 4u /* of a symbol, beside the bits of its two slots */

#if __ELF_NATIVE_CLASS == 64
#define RELOCATION_SYMBOL(info) ELF64_R_SYM(info)
#define RELOCATION_TYPE(info) ELF64_R_TYPE(info)
#else
#define RELOCATION_SYMBOL(info) ELF32_R_SYM(info)
#define RELOCATION_TYPE(info) ELF32_R_TYPE(info)
#endif

/* What a type does, on the machines whose types are known here; on others nothing is said of
 * types. */
enum meaning { OTHER, NONE, RELATIVE, INDIRECT, SYMBOLIC, SLOT, THREAD, WRONG };

static enum meaning meaning_of(uint32_t type)
{
#if defined(__x86_64__) && __ELF_NATIVE_CLASS == 64
    switch (type) {
    case R_X86_64_NONE:
        return NONE;
    case R_X86_64_RELATIVE:
        return RELATIVE;
    case R_X86_64_IRELATIVE:
        return INDIRECT;
    case R_X86_64_64:
        return SYMBOLIC;
    case R_X86_64_GLOB_DAT:
    case R_X86_64_JUMP_SLOT:
        return SLOT;
    case R_X86_64_DTPMOD64:
    case R_X86_64_DTPOFF64:
    case R_X86_64_TPOFF64:
    case R_X86_64_TLSDESC:
        return THREAD;
    default:
        return WRONG;
    }
#elif defined(__aarch64__) && __ELF_NATIVE_CLASS == 64
    switch (type) {
    case R_AARCH64_NONE:
        return NONE;
    case R_AARCH64_RELATIVE:
        return RELATIVE;
    case R_AARCH64_IRELATIVE:
        return INDIRECT;
    case R_AARCH64_ABS64:
        return SYMBOLIC;
    case R_AARCH64_GLOB_DAT:
    case R_AARCH64_JUMP_SLOT:
        return SLOT;
    case R_AARCH64_TLS_DTPMOD:
    case R_AARCH64_TLS_DTPREL:
    case R_AARCH64_TLS_TPREL:
    case R_AARCH64_TLSDESC:
        return THREAD;
    default:
        return WRONG;
    }
#else
    (void)type;
    return OTHER;
#endif
}

struct relocation {
    uint64_t offset, symbol, addend;
    uint32_t type;
};

/* Entry i of a table; a missing addend is that in place. */
static struct relocation relocation_at(const struct image *im, const unsigned char *table,
                                       bool has_addend, uint64_t i)
{
    ElfW(Rela) a = {0};
    ElfW(Addr) in_place = 0;
    const void *p;

    memcpy(&a, table + i * (has_addend ? sizeof(ElfW(Rela)) : sizeof(ElfW(Rel))),
           has_addend ? sizeof(ElfW(Rela)) : sizeof(ElfW(Rel)));
    p = has_addend ? NULL : image_at(im, a.r_offset, WORD, PF_R);
    if (p)
        memcpy(&in_place, p, WORD);
    return (struct relocation){a.r_offset, RELOCATION_SYMBOL(a.r_info),
                               has_addend ? (uint64_t)a.r_addend : in_place,
                               (uint32_t)RELOCATION_TYPE(a.r_info)};
}

static bool has_thread_segment(const struct image *im)
{
    for (unsigned i = 0; i < im->n_segment; i++)
        if (im->segment[i].p_type == PT_TLS)
            return true;
    return false;
}

/* A slot of the table of addresses stands in a section of that name: nothing else is a slot. */
static bool is_in_table(const struct image *im, uint64_t offset)
{
    const elf_section *s = image_section(im, offset);

    return im->n_section == 0 || (s && image_section_begins(im, s, ".got"));
}

/* What a relative relocation replaces is nothing yet, or the very address. */
static bool is_free(const struct image *im, const struct relocation *r)
{
    const elf_section *s = image_section(im, r->offset);
    const void *p = image_at(im, r->offset, WORD, PF_W);
    ElfW(Addr) there = 0;

    if (p)
        memcpy(&there, p, WORD);
    return (there == 0 || there == r->addend) && !(s && s->sh_type == SHT_DYNAMIC);
}

static bool is_relocation_right(const struct image *im, const struct relocation *r)
{
    const enum meaning meaning = meaning_of(r->type);
    const elf_symbol s = image_symbol(im, r->symbol < im->n_symbol ? r->symbol : 0);

    if (meaning == NONE)
        return r->offset == 0 && r->addend == 0;
    if (meaning == WRONG || r->symbol >= im->n_symbol || !image_at(im, r->offset, WORD, PF_W) ||
        (meaning != OTHER && r->offset % WORD != 0))
        return false;
    switch (meaning) {
    case RELATIVE:
        return r->symbol == 0 && r->addend <= image_end(im) && is_free(im, r);
    case INDIRECT:
        return r->symbol == 0 && image_has(im, r->addend, 1, PF_X);
    case SYMBOLIC:
        return r->symbol > 0;
    case SLOT:
        return r->symbol > 0 && r->addend == 0 && is_in_table(im, r->offset);
    case THREAD:
        return has_thread_segment(im) ||
               (r->symbol > 0 && s.st_shndx == SHN_UNDEF && (s.st_info & 0xf) == STT_TLS);
    default:
        return true;
    }
}

/* -- Tables -------- */

struct table {
    const unsigned char *data;
    uint64_t n;
    bool has_addend;
};

/* An empty one where there is none; false: it is not where it says. */
static bool find_table(const struct image *im, int64_t address, int64_t size, bool has_addend,
                       struct table *t)
{
    uint64_t at = 0, bytes = 0;

    *t = (struct table){NULL, 0, has_addend};
    if (!image_tag(im, address, &at) || !image_tag(im, size, &bytes))
        return true;
    t->n = bytes / (has_addend ? sizeof(ElfW(Rela)) : sizeof(ElfW(Rel)));
    t->data = image_at(im, at, bytes, PF_R);
    return t->data && at % WORD == 0;
}

/* RELA, REL and JMPREL. */
static bool find_tables(const struct image *im, struct table t[3])
{
    uint64_t kind = DT_RELA;

    image_tag(im, DT_PLTREL, &kind);
    return find_table(im, DT_RELA, DT_RELASZ, true, &t[0]) &&
           find_table(im, DT_REL, DT_RELSZ, false, &t[1]) &&
           find_table(im, DT_JMPREL, DT_PLTRELSZ, kind == DT_RELA, &t[2]);
}

/* The first so many are taken for relative ones without a look. Linkers that count them sort
 * them too. */
static bool is_count_right(const struct image *im, const struct table *t, int64_t tag)
{
    uint64_t n = 0, last = 0;

    if (!image_tag(im, tag, &n))
        return true;
    if (n > t->n)
        return false;
    for (uint64_t i = 0; i < n; i++) {
        const struct relocation r = relocation_at(im, t->data, t->has_addend, i);
        const enum meaning meaning = meaning_of(r.type);
        if ((meaning != RELATIVE && meaning != OTHER) || (i > 0 && r.offset <= last))
            return false;
        last = r.offset;
    }
    return true;
}

/* Relative relocations, packed: an address, then bits for the words behind it. `wanted`: is this
 * word among them? With UINT64_MAX all are looked at, and false says that one is wrong. */
static bool walk_packed(const struct image *im, uint64_t wanted)
{
    uint64_t at = 0, bytes = 0, where = 0;
    const unsigned char *p;

    if (!image_tag(im, DT_RELR, &at) || !image_tag(im, DT_RELRSZ, &bytes))
        return wanted == UINT64_MAX;
    p = image_at(im, at, bytes, PF_R);
    for (uint64_t i = 0; p && i < bytes / WORD; i++) {
        ElfW(Addr) entry;
        memcpy(&entry, p + i * WORD, WORD);
        for (unsigned bit = 0; bit < 8 * WORD; bit++) {
            const bool is_address = !(entry & 1);
            const uint64_t here = is_address ? entry : where + (bit - 1) * WORD;
            if (is_address ? bit > 0 : bit == 0 || !(entry >> bit & 1))
                continue;
            if (here == wanted)
                return true;
            if (wanted == UINT64_MAX && !image_has(im, here, WORD, PF_W))
                return false;
        }
        where = entry & 1 ? where + (8 * WORD - 1) * WORD : entry + WORD;
    }
    return wanted == UINT64_MAX && p;
}

/* -- Functions that run on loading and closing -------- */

static bool is_called_right(const struct image *im, const struct table t[3], uint64_t slot)
{
    for (int k = 0; k < 3; k++)
        for (uint64_t i = 0; i < t[k].n; i++) {
            const struct relocation r = relocation_at(im, t[k].data, t[k].has_addend, i);
            if (r.offset != slot)
                continue;
            if (meaning_of(r.type) == RELATIVE)
                return image_has(im, r.addend, 1, PF_X);
            return meaning_of(r.type) == SYMBOLIC || meaning_of(r.type) == OTHER;
        }
    return walk_packed(im, slot);
}

static bool is_list_right(const struct image *im, const struct table t[3], int64_t address,
                          int64_t size)
{
    uint64_t at = 0, bytes = 0;
    const bool has = image_tag(im, address, &at);

    if (has != image_tag(im, size, &bytes))
        return false;
    if (!has)
        return true;
    if (at % WORD != 0 || bytes % WORD != 0 || bytes > 65536 || !image_at(im, at, bytes, PF_R))
        return false;
    for (uint64_t i = 0; i < bytes / WORD; i++)
        if (!is_called_right(im, t, at + i * WORD))
            return false;
    return true;
}

/* Nothing is relocated twice, and no symbol has two slots of one type (one for calls and one for
 * its address are two types): linkers see to that, damage does not. `word` has a byte for each
 * word of the file, `slot` one for each symbol. */
static bool is_first(const struct image *im, const struct relocation *r, unsigned char *word,
                     unsigned char *slot)
{
    const enum meaning meaning = meaning_of(r->type);
    const unsigned char *p = image_at(im, r->offset, WORD, PF_W);
    const unsigned char type = (unsigned char)(1u << (r->type & 1));

    if (meaning == NONE || meaning == OTHER || !p)
        return true;
    if (word[(size_t)(p - im->data) / WORD]++)
        return false;
    if (meaning == SLOT && (slot[r->symbol] & type))
        return false;
    slot[r->symbol] = (unsigned char)(slot[r->symbol] | (meaning == SLOT ? type : USED));
    return true;
}

/* The compiler's own code that runs on loading and closing calls these through their slots, if they
 * are there: one without a slot has lost it to another symbol. */
static bool is_called(const char *name)
{
    static const char *const names[] = {"__gmon_start__", "__cxa_finalize",
                                        "_ITM_registerTMCloneTable", "_ITM_deregisterTMCloneTable"};

    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

static bool is_exchanged(const struct image *im, const unsigned char *slot)
{
    for (uint64_t i = 1; i < im->n_symbol; i++) {
        const elf_symbol s = image_symbol(im, i);
        if (slot[i] == 0 && s.st_shndx == SHN_UNDEF && is_called(im->strings + s.st_name))
            return true;
    }
    return false;
}

static int check_tables(const struct image *im, const struct table t[3], unsigned char *word,
                        unsigned char *slot, struct error *e)
{
    for (int k = 0; k < 3; k++)
        for (uint64_t i = 0; i < t[k].n; i++) {
            const struct relocation r = relocation_at(im, t[k].data, t[k].has_addend, i);
            if (!is_relocation_right(im, &r))
                return error_set(
                    e, EXIT_REFUSED,
                    "it is damaged: relocation %llu (type %u) at 0x%llx is none that a "
                    "shared object can have",
                    (unsigned long long)i, r.type, (unsigned long long)r.offset);
            if (!is_first(im, &r, word, slot))
                return error_set(
                    e, EXIT_REFUSED,
                    "it is damaged: relocation %llu (type %u) at 0x%llx does what another "
                    "one does",
                    (unsigned long long)i, r.type, (unsigned long long)r.offset);
        }
    return is_exchanged(im, slot)
               ? image_damaged("a symbol of it stands in the place of another", e)
               : 0;
}

int image_check_relocations(const struct image *im, struct error *e)
{
    struct table t[3];
    unsigned char *word, *slot;
    int status;

    if (!find_tables(im, t) || !is_count_right(im, &t[0], DT_RELACOUNT) ||
        !is_count_right(im, &t[1], DT_RELCOUNT) || !walk_packed(im, UINT64_MAX))
        return image_damaged("its tables of relocations are odd", e);
    word = calloc((size_t)im->size / WORD + 1, 1);
    slot = calloc((size_t)im->n_symbol + 1, 1);
    status = word && slot ? check_tables(im, t, word, slot, e)
                          : error_memory(e, "a table of relocations", im->size / WORD);
    free(word);
    free(slot);
    if (status)
        return -1;
    if (!is_list_right(im, t, DT_INIT_ARRAY, DT_INIT_ARRAYSZ) ||
        !is_list_right(im, t, DT_FINI_ARRAY, DT_FINI_ARRAYSZ))
        return image_damaged("a function that it runs on loading or closing is no code", e);
    return 0;
}
