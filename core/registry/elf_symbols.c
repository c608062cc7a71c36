/* registry/elf_symbols.c -- hash tables, symbols and versions of a shared object (see
 * elf_image.h). The dynamic linker walks chains in them until a mark that a damaged file may
 * lack. */
#include "config.h"

#include "registry/elf_image.h"

#include <string.h>

#define ADDRESS_BITS (8u * (uint32_t)sizeof(void *))
#define SYMBOLS_MAX (1u << 24)
#define SYMBOL_TYPE(s) ((s).st_info & 0xfu)
#define SYMBOL_BIND(s) ((uint32_t)(s).st_info >> 4)

static uint32_t word(const unsigned char *p, uint64_t i)
{
    uint32_t value;

    memcpy(&value, p + i * sizeof(value), sizeof(value));
    return value;
}

static uint16_t half(const unsigned char *p, uint64_t i)
{
    uint16_t value;

    memcpy(&value, p + i * sizeof(value), sizeof(value));
    return value;
}

elf_symbol image_symbol(const struct image *im, uint64_t i)
{
    elf_symbol s;

    memcpy(&s, im->symbols + i * sizeof(s), sizeof(s));
    return s;
}

static uint32_t gnu_hash(const char *name)
{
    uint32_t h = 5381;

    for (; *name; name++)
        h = h * 33 + (unsigned char)*name;
    return h;
}

static uint32_t old_hash(const char *name)
{
    uint32_t h = 0;

    for (; *name; name++) {
        h = (h << 4) + (unsigned char)*name;
        h = (h ^ (h >> 24 & 0xf0u)) & 0x0fffffffu;
    }
    return h;
}

/* -- How many symbols there are -------- */

/* nbucket, nchain, buckets, chains. */
static bool count_by_old_hash(const struct image *im, uint64_t at, uint64_t *n)
{
    const unsigned char *p = image_at(im, at, 8, PF_R);
    uint64_t buckets, chains;

    if (!p || at % 4 != 0)
        return false;
    buckets = word(p, 0);
    chains = word(p, 1);
    if (buckets == 0 || chains > SYMBOLS_MAX || buckets > SYMBOLS_MAX)
        return false;
    p = image_at(im, at, 4 * (2 + buckets + chains), PF_R);
    for (uint64_t i = 0; p && i < buckets + chains; i++)
        if (word(p, 2 + i) >= chains)
            return false;
    /* A chain that runs in a circle is one that visits more than all. */
    for (uint64_t i = 0; p && i < buckets; i++) {
        uint64_t steps = 0;
        for (uint32_t k = word(p, 2 + i); k; k = word(p, 2 + buckets + k))
            if (++steps > chains)
                return false;
    }
    *n = chains;
    return p != NULL;
}

struct gnu_table {
    const unsigned char *bucket;
    uint64_t buckets, first, chain; /* address of the chain word of symbol `first` */
};

/* nbuckets, symoffset, bloom_size, bloom_shift, bloom, buckets, chains without a length: they
 * end where that of the last bucket has its mark. */
static bool count_by_gnu_hash(const struct image *im, uint64_t at, struct gnu_table *t, uint64_t *n)
{
    const unsigned char *p = image_at(im, at, 16, PF_R);
    uint64_t bloom, last = 0;

    if (!p || at % sizeof(void *) != 0)
        return false;
    t->buckets = word(p, 0);
    t->first = word(p, 1);
    bloom = word(p, 2);
    if (t->buckets == 0 || t->buckets > SYMBOLS_MAX || t->first > SYMBOLS_MAX || bloom == 0 ||
        bloom > SYMBOLS_MAX || (bloom & (bloom - 1)) || word(p, 3) >= ADDRESS_BITS)
        return false;
    t->chain = at + 16 + bloom * sizeof(ElfW(Addr)) + 4 * t->buckets;
    p = image_at(im, at, t->chain - at, PF_R);
    if (!p)
        return false;
    t->bucket = p + 16 + bloom * sizeof(ElfW(Addr));
    for (uint64_t i = 0; i < t->buckets; i++) {
        const uint32_t b = word(t->bucket, i);
        if (b != 0 && b < t->first)
            return false;
        last = b > last ? b : last;
    }
    for (; last > 0; last++) {
        p = image_at(im, t->chain + 4 * (last - t->first), 4, PF_R);
        if (!p)
            return false;
        if (word(p, 0) & 1)
            break;
    }
    *n = last > 0 ? last + 1 : t->first;
    return true;
}

/* Every hashed symbol's name has the hash that stands in its chain. */
static bool are_hashes_right(const struct image *im, const struct gnu_table *t)
{
    for (uint64_t i = t->first; i < im->n_symbol; i++) {
        const unsigned char *p = image_at(im, t->chain + 4 * (i - t->first), 4, PF_R);
        const elf_symbol s = image_symbol(im, i);
        uint32_t h;
        if (!p || s.st_name >= im->n_string)
            return false;
        h = gnu_hash(im->strings + s.st_name);
        if (((word(p, 0) ^ h) & ~1u) != 0 || word(t->bucket, h % t->buckets) == 0)
            return false;
    }
    return true;
}

static int find_symbols(struct image *im, struct error *e)
{
    struct gnu_table gnu = {0};
    uint64_t at = 0, old = 0, n = 0, symbols = 0;
    const bool has_old = image_tag(im, DT_HASH, &at);
    const elf_section *s;

    if (has_old && !count_by_old_hash(im, at, &old))
        return image_damaged("its hash table is odd", e);
    if (image_tag(im, DT_GNU_HASH, &at)) {
        if (!count_by_gnu_hash(im, at, &gnu, &n) || (has_old && n > old))
            return image_damaged("its hash table is odd", e);
    } else if (!has_old) {
        return image_damaged("it has no hash table", e);
    }
    im->n_symbol = has_old ? old : n;
    if (!image_tag(im, DT_SYMTAB, &symbols) || symbols % sizeof(void *) != 0)
        return image_damaged("it has no symbols", e);
    im->symbols = image_at(im, symbols, im->n_symbol * sizeof(elf_symbol), PF_R);
    if (!im->symbols)
        return image_damaged("its symbols are not where it says", e);
    s = image_section(im, symbols);
    if (s && s->sh_size / sizeof(elf_symbol) > im->n_symbol && gnu.buckets && n == gnu.first)
        im->n_symbol = s->sh_size / sizeof(elf_symbol); /* none is hashed, so none was counted */
    else if (s && s->sh_size != im->n_symbol * sizeof(elf_symbol))
        return image_damaged("its hash table does not fit its symbols", e);
    if (gnu.buckets && n > gnu.first && !are_hashes_right(im, &gnu))
        return image_damaged("its hash table does not fit its symbols", e);
    return 0;
}

/* -- Symbols -------- */

static bool is_undefined_right(const elf_symbol *s)
{
    /* One that is nowhere can only be looked for by name, everywhere. */
    return (SYMBOL_BIND(*s) == STB_GLOBAL || SYMBOL_BIND(*s) == STB_WEAK) &&
           (s->st_other & 3) == STV_DEFAULT;
}

static bool is_defined_right(const struct image *im, const elf_symbol *s)
{
    const uint32_t type = SYMBOL_TYPE(*s);

    if (s->st_shndx == SHN_ABS)
        return type != STT_GNU_IFUNC;
    if (im->n_section > 0 && s->st_shndx >= im->n_section)
        return false;
    if (type == STT_TLS)
        return s->st_value < (1u << 24);
    if (type == STT_FUNC || type == STT_GNU_IFUNC)
        return image_has(im, s->st_value, 1, PF_X);
    return image_has(im, s->st_value, 0, 0) || s->st_value == image_end(im);
}

static bool is_entry(const struct image *im, const elf_symbol *s, const char *entry)
{
    return s->st_shndx != SHN_UNDEF && strcmp(im->strings + s->st_name, entry) == 0 &&
           SYMBOL_TYPE(*s) == STT_FUNC && (s->st_other & 3) == STV_DEFAULT &&
           (SYMBOL_BIND(*s) == STB_GLOBAL || SYMBOL_BIND(*s) == STB_WEAK) &&
           image_at(im, s->st_value, s->st_size ? s->st_size : 1, PF_X) != NULL;
}

static int check_symbols(const struct image *im, const char *entry, struct error *e)
{
    bool found = false;

    for (uint64_t i = 1; i < im->n_symbol; i++) {
        const elf_symbol s = image_symbol(im, i);
        if (s.st_name >= im->n_string)
            return image_damaged("a symbol's name is not in its strings", e);
        if (s.st_shndx == SHN_UNDEF ? !is_undefined_right(&s) : !is_defined_right(im, &s))
            return error_set(e, EXIT_REFUSED, "it is damaged: symbol %llu is where none can be",
                             (unsigned long long)i);
        found = found || is_entry(im, &s, entry);
    }
    return found ? 0
                 : error_set(e, EXIT_REFUSED, "it has no function %s, so is not a plugin of sph",
                             entry);
}

/* -- Versions -------- */

static bool is_needed(const struct image *im, uint64_t name)
{
    for (unsigned i = 0; i < im->n_dynamic; i++)
        if (im->dynamic[i].d_tag == DT_NEEDED &&
            strcmp(im->strings + im->dynamic[i].d_un.d_val, im->strings + name) == 0)
            return true;
    return false;
}

/* The versions asked of one library; *largest grows to their largest number. */
static bool check_needed(const struct image *im, uint64_t at, uint16_t n, uint16_t *largest)
{
    for (uint16_t i = 0; i < n; i++) {
        ElfW(Vernaux) aux;
        const void *p = image_at(im, at, sizeof(aux), PF_R);
        if (!p || at % 4 != 0)
            return false;
        memcpy(&aux, p, sizeof(aux));
        if (aux.vna_name >= im->n_string || aux.vna_hash != old_hash(im->strings + aux.vna_name) ||
            (aux.vna_next == 0) != (i + 1 == n))
            return false;
        if ((aux.vna_other & 0x7fffu) > *largest)
            *largest = aux.vna_other & 0x7fffu;
        at += aux.vna_next;
    }
    return true;
}

static bool check_verneed(const struct image *im, uint16_t *largest)
{
    uint64_t at = 0, n = 0;
    const bool has = image_tag(im, DT_VERNEED, &at);

    if (has != image_tag(im, DT_VERNEEDNUM, &n))
        return false;
    for (uint64_t i = 0; has && i < n; i++) {
        ElfW(Verneed) need;
        const void *p = image_at(im, at, sizeof(need), PF_R);
        if (!p || at % 4 != 0)
            return false;
        memcpy(&need, p, sizeof(need));
        if (need.vn_version != VER_NEED_CURRENT || need.vn_file >= im->n_string ||
            need.vn_cnt == 0 || !is_needed(im, need.vn_file) ||
            (need.vn_next == 0) != (i + 1 == n) ||
            !check_needed(im, at + need.vn_aux, need.vn_cnt, largest))
            return false;
        at += need.vn_next;
    }
    return !has || n > 0;
}

static bool check_verdef(const struct image *im, uint16_t *largest)
{
    uint64_t at = 0, n = 0;
    const bool has = image_tag(im, DT_VERDEF, &at);

    if (has != image_tag(im, DT_VERDEFNUM, &n))
        return false;
    for (uint64_t i = 0; has && i < n; i++) {
        ElfW(Verdef) def;
        ElfW(Verdaux) aux;
        const void *p = image_at(im, at, sizeof(def), PF_R);
        if (!p || at % 4 != 0)
            return false;
        memcpy(&def, p, sizeof(def));
        p = image_at(im, at + def.vd_aux, sizeof(aux), PF_R);
        if (!p || def.vd_version != VER_DEF_CURRENT || def.vd_cnt == 0 || def.vd_aux % 4 != 0 ||
            (def.vd_next == 0) != (i + 1 == n))
            return false;
        memcpy(&aux, p, sizeof(aux));
        if (aux.vda_name >= im->n_string)
            return false;
        if ((def.vd_ndx & 0x7fffu) > *largest)
            *largest = def.vd_ndx & 0x7fffu;
        at += def.vd_next;
    }
    return !has || n > 0;
}

static int check_versions(const struct image *im, struct error *e)
{
    const unsigned char *p;
    uint16_t largest = 1; /* 0 and 1: local and global, of no version */
    uint64_t at = 0;

    if (!check_verneed(im, &largest) || !check_verdef(im, &largest))
        return image_damaged("its versions of symbols are odd", e);
    if (!image_tag(im, DT_VERSYM, &at))
        return 0;
    p = image_at(im, at, 2 * im->n_symbol, PF_R);
    if (!p || at % 2 != 0)
        return image_damaged("its versions of symbols are not where it says", e);
    for (uint64_t i = 0; i < im->n_symbol; i++)
        if ((half(p, i) & 0x7fffu) > largest)
            return image_damaged("a symbol is of a version that is not there", e);
    return largest > 1 || image_tag(im, DT_VERNEED, &at) || image_tag(im, DT_VERDEF, &at)
               ? 0
               : image_damaged("its versions of symbols are odd", e);
}

int image_check_symbols(struct image *im, const char *entry, struct error *e)
{
    if (find_symbols(im, e) || check_versions(im, e))
        return -1;
    return check_symbols(im, entry, e);
}
