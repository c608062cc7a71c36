/* plugins.h -- for tests that run what plugins have registered: loads a plugin by name, and calls
 * an item's functions on small arrays of doubles. */
#ifndef TEST_PLUGINS_H
#define TEST_PLUGINS_H

#include "registry/loader.h"

#include <stdio.h>

#define PLUGINS_COLUMNS 16
#define PLUGINS_PARAMS 16

/* One use of an item, on columns that the test owns. */
struct trial {
    struct registry *registry;
    const sph_item *item;
    const sph_life *life;
    struct sph_config config;
    void *state;
    sph_batch batch;
    sph_column column[PLUGINS_COLUMNS];
};

/* Each fails the test if it cannot. */
void plugins_load(struct registry *r, const char *name);
const struct entry *plugins_find(const struct registry *r, enum kind kind, const char *name);

/* Parameters: names, ended by NULL, and their values; of a choice, its index. */
void plugins_set(struct sph_config *c, const sph_item *item, const char *const *names,
                 const double *values);
void trial_init(struct trial *u, struct registry *r, const sph_item *item, const sph_life *life,
                const sph_list *props, int dim, const char *const *names, const double *values);
void trial_fini(struct trial *u);
/* Columns in declared order: n particles, component c at data + c * n. NULL: not present. */
void use_column(struct trial *u, uint32_t k, double *data, uint64_t n);
sph_status use_run(struct trial *u, sph_range_fn run, double time, uint64_t n);

/* A table of tests/reference, row by row; *columns a row. What is no number is NaN. The caller frees
 * it. */
double *plugins_table(const char *file, int *columns, int *rows);
/* Its text: a line that says where it is from, one of names, then the rows. */
FILE *plugins_open_table(const char *file);

#endif
