/* registry/check.h -- does a descriptor contradict itself? One sentence naming the field if it
 * does. */
#ifndef REGISTRY_CHECK_H
#define REGISTRY_CHECK_H

#include "registry/registry.h"
#include <stdbool.h>

/* Longest name of an item, a property or a parameter, and longest text. */
#define CHECK_NAME_MAX 63u
#define CHECK_TEXT_MAX 4095u

/* [a-z][a-z0-9-]*: items and plugins. */
bool check_is_name(const char *s);
/* [A-Za-z][A-Za-z0-9_]*: properties, parameters (these may have '-'), reductions. */
bool check_is_word(const char *s, bool dash);
/* One line of valid UTF-8 of at most CHECK_TEXT_MAX bytes. */
bool check_is_text(const char *s);

/* A host's copy (registry/copy.h) of a descriptor. The sentence does not name the item. */
int check_descriptor(enum kind kind, const void *descriptor, struct error *e);

/* What every kind shares, in check_item.c: names, dimensions, parameters, properties. */
int check_item(const sph_item *item, struct error *e);
int check_props(const sph_list *props, const char *list, struct error *e);
/* The property of that name in a list of sph_prop, or NULL. */
const sph_prop *check_find_prop(const sph_list *props, const char *name);

/* The bodies for a device of a function or an equation of state, as far as it has them, in
 * check_device.c. */
int check_devices(const sph_function *f, struct error *e);
int check_device_eos(const sph_eos *eos, struct error *e);

/* Knots, powers, support and integral, in check_kernel.c. */
int check_kernel(const sph_kernel *k, struct error *e);

#endif
