/* rig.c -- see rig.h. */
#include "config.h"

#include "rig.h"

#include "mock.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* An entry function gets no argument. */
static const struct rig_items *current;

static sph_status init(const sph_host *host)
{
    sph_status status = host->register_item(host, SPH_KIND_KERNEL, &mock.kernel);
    for (size_t i = 0; status == SPH_OK && current->function[i]; i++)
        status = host->register_item(host, SPH_KIND_FUNCTION, current->function[i]);
    for (size_t i = 0; status == SPH_OK && current->eos[i]; i++)
        status = host->register_item(host, SPH_KIND_EOS, current->eos[i]);
    for (size_t i = 0; status == SPH_OK && current->scheme[i]; i++)
        status = host->register_item(host, SPH_KIND_SCHEME, current->scheme[i]);
    for (size_t i = 0; status == SPH_OK && current->boundary[i]; i++)
        status = host->register_item(host, SPH_KIND_BOUNDARY, current->boundary[i]);
    return status == SPH_OK && current->more ? current->more(host) : status;
}

static const sph_plugin *entry(void)
{
    static const sph_plugin plugin = {(uint32_t)sizeof(sph_plugin),
                                      SPH_PLUGIN_MAGIC,
                                      SPH_ABI_MAJOR,
                                      SPH_ABI_MINOR,
                                      "rig",
                                      "1.0",
                                      "none",
                                      "the functions of a test",
                                      init,
                                      NULL};
    return &plugin;
}

static char *format(const char *scene, va_list args)
{
    char *text = calloc(1, 8192);
    assert_non_null(text);
    const int n = vsnprintf(text, 8192, scene, args);
    assert_in_range(n, 1, 8191);
    for (char *s = text; *s; s++)
        if (*s == '\'')
            *s = '"';
    return text;
}

static int make(struct rig *r, const struct rig_items *items, char *text, struct error *e)
{
    *r = (struct rig){.text = text};
    if (document_parse(&r->document, "scene.json", text, strlen(text), e))
        return -1;
    r->has_document = true;
    if (scene_compile(&r->scene, &r->document, e))
        return -1;
    r->has_scene = true;
    if (registry_init(&r->registry, e))
        return -1;
    r->has_registry = true;
    mock_reset(KIND_KERNEL);
    current = items;
    if (registry_add(&r->registry, "/rig/rig.so", entry, NULL, NULL, e))
        return -1;
    r->has_plan = true;
    return plan_make(&r->plan, &r->registry, &r->scene, false, e) || plan_fill(&r->plan, e) ? -1
                                                                                            : 0;
}

int rig_make(struct rig *r, const struct rig_items *items, struct error *e, const char *scene, ...)
{
    va_list args;
    va_start(args, scene);
    char *text = format(scene, args);
    va_end(args);
    return make(r, items, text, e);
}

void rig_open(struct rig *r, const struct rig_items *items, const char *scene, ...)
{
    struct error e = {0};
    va_list args;
    va_start(args, scene);
    char *text = format(scene, args);
    va_end(args);
    if (make(r, items, text, &e))
        fail_msg("%s", e.text);
}

void rig_close(struct rig *r)
{
    if (r->has_plan)
        plan_free(&r->plan);
    if (r->has_registry)
        registry_fini(&r->registry);
    if (r->has_scene)
        scene_free(&r->scene);
    if (r->has_document)
        document_free(&r->document);
    free(r->text);
    *r = (struct rig){0};
}

void rig_refused(const struct rig_items *items, const char *text, const char *scene, ...)
{
    struct rig r;
    struct error e = {0};
    va_list args;
    va_start(args, scene);
    char *json = format(scene, args);
    va_end(args);
    if (!make(&r, items, json, &e))
        fail_msg("accepted, in place of: %s", text);
    if (!strstr(e.text, text))
        fail_msg("says: %s\nin place of: %s", e.text, text);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    rig_close(&r);
}

double *rig_real(const struct rig *r, size_t a, const char *column, uint32_t c)
{
    double *data = particles_real(&r->plan.array[a].p, column, c);
    if (!data)
        fail_msg("array %zu has no column \"%s\"", a, column);
    return data;
}
