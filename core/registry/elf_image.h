/* registry/elf_image.h -- a shared object's file, read into memory and looked at as the dynamic
 * linker will look at it. For the preflight alone: nothing here is mapped or run. */
#ifndef REGISTRY_ELF_IMAGE_H
#define REGISTRY_ELF_IMAGE_H

#include "base/error.h"
#include <elf.h>
#include <link.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef ElfW(Ehdr) elf_header;
typedef ElfW(Phdr) elf_segment;
typedef ElfW(Shdr) elf_section;
typedef ElfW(Dyn) elf_dynamic;
typedef ElfW(Sym) elf_symbol;

struct image {
    unsigned char *data; /* the whole file */
    uint64_t size;
    elf_header header;
    elf_segment *segment;
    unsigned n_segment;
    elf_section *section; /* none in a file without them */
    unsigned n_section;
    elf_dynamic *dynamic; /* without its end */
    unsigned n_dynamic;
    const char *strings; /* the dynamic string table; its last byte is NUL */
    uint64_t n_string;
    const unsigned char *symbols; /* the dynamic symbols: image_symbol */
    uint64_t n_symbol;
};

/* Reads the file behind `fd` and checks its header, segments and sections. The sentence does not
 * name the file. To be freed with image_fini, also after a failure. */
int image_init(struct image *im, int fd, uint64_t size, struct error *e);
void image_fini(struct image *im);

/* What will be at [address, address + n) when the file is mapped, if those bytes come from the
 * file and lie in one segment that has all of `flags` (PF_...); else NULL. */
const void *image_at(const struct image *im, uint64_t address, uint64_t n, uint32_t flags);
/* Will there be memory at [address, address + n), with these flags? Zeroed memory counts too. */
bool image_has(const struct image *im, uint64_t address, uint64_t n, uint32_t flags);
/* One past the last address. */
uint64_t image_end(const struct image *im);
/* The section that holds an address, or NULL. */
const elf_section *image_section(const struct image *im, uint64_t address);
/* Does its name begin so? */
bool image_section_begins(const struct image *im, const elf_section *s, const char *text);

/* elf_dynamic.c: the dynamic section, symbols, hashes, versions; fills the members from
 * `dynamic` on. */
int image_check_dynamic(struct image *im, struct error *e);
/* The value of a tag of the dynamic section. */
bool image_tag(const struct image *im, int64_t tag, uint64_t *value);
elf_symbol image_symbol(const struct image *im, uint64_t i);
/* "it is damaged: WHAT" */
int image_damaged(const char *what, struct error *e);

/* elf_symbols.c: hash tables (which say how many symbols there are), symbols, the entry,
 * versions. */
int image_check_symbols(struct image *im, const char *entry, struct error *e);

/* elf_relocations.c: relocations, and the lists of functions that run on loading and closing. */
int image_check_relocations(const struct image *im, struct error *e);

#endif
