/* base/store.h -- named blocks of numbers, written or read back: the one road by which structures go into a
 * checkpoint and come out again. A structure has one function that names its blocks; it is the same for
 * both directions, so that what is written is what is read. Knows nothing of files. */
#ifndef BASE_STORE_H
#define BASE_STORE_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum store_type {
    STORE_U8, /* bytes, texts, bools, structures as they are */
    STORE_U16,
    STORE_U32,
    STORE_U64,
    STORE_I32,
    STORE_I64,
    STORE_F32,
    STORE_F64
};

struct store {
    bool reading;
    /* Writes n elements of data, or reads exactly n into it. */
    int (*block)(struct store *s, const char *path, enum store_type type, void *data, size_t n,
                 struct error *e);
    /* Reading: how many elements there are; SIZE_MAX: no such block. */
    size_t (*count)(struct store *s, const char *path);
    const char *shown; /* the file, for messages */
    char group[192];   /* what names are put behind: "array0/column3/" */
    /* Reads n elements from `first` on. */
    int (*piece)(struct store *s, const char *path, enum store_type type, void *data, size_t first,
                 size_t n, struct error *e);
};

/* Bytes of an element. */
size_t store_size(enum store_type type);

/* Names until the matching leave stand in this group, within that of before. */
void store_enter(struct store *s, const char *name, size_t index);
void store_leave(struct store *s);

/* n elements in place. */
int store_block(struct store *s, const char *name, enum store_type type, void *data, size_t n,
                struct error *e);
/* Reading: n elements from `first` on, of a block that may have more. */
int store_piece(struct store *s, const char *name, enum store_type type, void *data, size_t first,
                size_t n, struct error *e);
/* *n elements in memory of their own, which `*data` (a pointer to a pointer) shows. Reading frees what was
 * there and makes room for *n + spare. */
int store_array(struct store *s, const char *name, enum store_type type, void *data, size_t *n,
                size_t spare, struct error *e);
/* A text in memory of its own, or NULL. */
int store_text(struct store *s, const char *name, char **text, struct error *e);
/* Single numbers. */
int store_flags(struct store *s, const char *name, bool *flag, size_t n, struct error *e);
int store_count(struct store *s, const char *name, size_t *value, struct error *e);
int store_u64(struct store *s, const char *name, uint64_t *value, struct error *e);
int store_f64(struct store *s, const char *name, double *value, struct error *e);
/* Reading: is there such a block? */
bool store_has(struct store *s, const char *name);
/* Reading: what was read cannot be. "FILE: a broken checkpoint: " + why; EXIT_USAGE; -1. */
int store_broken(const struct store *s, struct error *e, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
