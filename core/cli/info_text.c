/* cli/info_text.c -- `sph info` for people: to stdout, at most 80 columns. */
#include "cli/info.h"
#include "integrators/integrator.h"
#include "registry/extension.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define COLUMNS 80
#define LABEL 14 /* width of the left column of an item's page */

/* Characters, not bytes, of a piece of UTF-8. */
static size_t width(const char *s, size_t n)
{
    size_t w = 0;

    for (size_t i = 0; i < n; i++)
        w += ((unsigned char)s[i] & 0xc0u) != 0x80u;
    return w;
}

/* Words from column `at` on; further lines begin at `indent`. Ends the line. */
static void wrap(size_t at, size_t indent, const char *text)
{
    bool first = true;

    while (*text) {
        const size_t n = strcspn(text, " ");
        const size_t w = width(text, n);
        if (!first && at + 1 + w > COLUMNS) {
            printf("\n%*s", (int)indent, "");
            at = indent;
            first = true;
        }
        if (n > 0) {
            printf("%s%.*s", first ? "" : " ", (int)n, text);
            at += w + !first;
            first = false;
        }
        text += n + (text[n] == ' ');
    }
    putchar('\n');
}

/* "  name          words, wrapped" with the words at column `indent`. */
static void labelled(size_t margin, size_t indent, const char *label, const char *text)
{
    const size_t w = margin + width(label, strlen(label));

    printf("%*s%s", (int)margin, "", label);
    if (w + 1 > indent)
        printf("\n%*s", (int)indent, "");
    else
        printf("%*s", (int)(indent - w), "");
    wrap(indent, indent, text);
}

static void field(const char *label, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void field(const char *label, const char *format, ...)
{
    char text[4096];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof(text), format, args);
    va_end(args);
    labelled(2, 2 + LABEL, label, text);
}

static void unit_text(const char *unit, char *out, size_t size)
{
    if (unit[0])
        snprintf(out, size, " [%.64s]", unit);
    else
        out[0] = '\0';
}

/* "at least 0", "1 to 100", "one of one|other"; empty where anything goes. */
static const char *range_text(const sph_param *p, char *out, size_t size)
{
    const bool below = p->max < 1e99; /* limits beyond that are there to keep infinity out */
    const bool above = p->min > -1e99;

    out[0] = '\0';
    if (p->choices)
        snprintf(out, size, "one of %s", p->choices);
    else if (p->min > p->max || (!above && !below))
        return out;
    else if (above && below)
        snprintf(out, size, "%.9g to %.9g", p->min, p->max);
    else
        snprintf(out, size, above ? "at least %.9g" : "at most %.9g", above ? p->min : p->max);
    return out;
}

static void param_text(const sph_param *p)
{
    char text[5000], value[128], unit[80], range[256];

    unit_text(p->unit, unit, sizeof(unit));
    info_default(p, value, sizeof(value));
    range_text(p, range, sizeof(range));
    if (p->type == SPH_PARAM_TABLE)
        snprintf(text, sizeof(text), "%s table: %s", value[0] ? "optional" : "mandatory", p->doc);
    else
        snprintf(text, sizeof(text), "%s%s%s%s%s%s%s", value[0] ? "default " : "mandatory", value,
                 unit, range[0] ? ", " : "", range, p->doc[0] ? ": " : "", p->doc);
    labelled(4, 4 + LABEL, p->name, text);
}

static void params_text(const sph_list *params)
{
    const sph_param *p = params->data;

    if (params->count > 0)
        puts("  Parameters");
    for (uint32_t i = 0; i < params->count; i++)
        param_text(&p[i]);
}

static void props_text(const char *title, const sph_list *props)
{
    const sph_prop *p = props->data;

    if (props->count > 0)
        printf("  %s\n", title);
    for (uint32_t i = 0; i < props->count; i++) {
        char text[5000], access[128], unit[80];
        unit_text(p[i].unit, unit, sizeof(unit));
        snprintf(text, sizeof(text), "%s%s; %s%s%s", info_type(p[i].type), unit,
                 info_access(p[i].access, access, sizeof(access)), p[i].doc[0] ? ": " : "",
                 p[i].doc);
        labelled(4, 4 + LABEL, p[i].name, text);
    }
}

static void rates_text(const sph_list *rates)
{
    const sph_rate *r = rates->data;

    for (uint32_t i = 0; i < rates->count; i++)
        field(i == 0 ? "Rates" : "", "d %s / dt = %s (%s)", r[i].property, r[i].rate,
              r[i].kind == SPH_DRIFT ? "drift" : "kick");
}

static void reductions_text(const sph_list *reductions)
{
    static const char *const op[] = {"?", "least", "largest", "sum of"};
    static const char *const use[] = {"", ", bounds the time step", ", the internal energy",
                                      ", the potential energy"};
    const sph_reduction *r = reductions->data;

    for (uint32_t i = 0; i < reductions->count; i++)
        field(i == 0 ? "Reductions" : "", "%s: %s %s%s", r[i].name, op[r[i].op], r[i].property,
              use[r[i].use]);
}

static void steps_text(const sph_list *steps)
{
    const sph_step *s = steps->data;

    for (uint32_t i = 0; i < steps->count; i++) {
        const bool eos = strcmp(s[i].kind, SPH_KIND_EOS) == 0;
        const char *place = s[i].after ? s[i].after : s[i].before;
        field(i == 0 ? "Steps" : "", "%s: %s%s%s%s", s[i].at,
              eos ? "the material's equation of state" : s[i].name,
              s[i].on == SPH_ON_BOUNDED ? ", on what it bounds" : "",
              !place       ? ""
              : s[i].after ? ", after "
                           : ", before ",
              place ? place : "");
    }
}

static void function_text(const sph_function *f)
{
    if (f->shape == SPH_PAIR)
        field("Shape", "pairs within %g support %s", f->reach_scale,
              f->reach == SPH_GATHER ? "of the destination" : "of the larger of the two");
    else
        field("Shape", "each particle alone");
    if (f->max_sweeps > 0)
        field("Sweeps", "at most %u, while %s is 1 anywhere", f->max_sweeps, f->unfinished);
    rates_text(&f->rates);
    reductions_text(&f->reductions);
}

/* What the plugin has said through extensions. */
static void extras_text(const struct entry *x)
{
    const sph_population *p = x->population;

    if (p && p->remove)
        field("Removes", "particles where %s is not 0", p->remove);
    if (p && p->create)
        field("Creates", "as many particles as %s says", p->create);
    if (x->state)
        field("State", "kept in a checkpoint, format %u", x->state->format);
}

static void kernel_text(const sph_kernel *k)
{
    field("Support", "%g h", k->support);
    field("Form", k->value ? "a function, tabulated" : "a sum of clamped powers");
}

static void backends_text(const struct entry *x)
{
    field("Backends", "cpu%s", entry_on_device(x) ? ", opencl" : "");
}

static void specific_text(const struct entry *x)
{
    switch (x->kind) {
    case KIND_FUNCTION:
        function_text(entry_function(x));
        backends_text(x);
        break;
    case KIND_EOS:
        props_text("Properties of its inverse", &entry_eos(x)->inverse_props);
        backends_text(x);
        break;
    case KIND_KERNEL:
        kernel_text(entry_kernel(x));
        break;
    case KIND_SCHEME:
        field("Kernel", "%s", entry_scheme(x)->kernel ? entry_scheme(x)->kernel : "none");
        field("Integrator", "%s, cfl %g", entry_scheme(x)->integrator, entry_scheme(x)->cfl);
        steps_text(&entry_scheme(x)->steps);
        rates_text(&entry_scheme(x)->rates);
        break;
    case KIND_BOUNDARY:
        steps_text(&entry_boundary(x)->steps);
        break;
    case KIND_EXACT:
    case KIND_COUNT:
        break;
    }
}

/* On the page of a plugin its file need not be told again. */
static void entry_text(const struct registry *r, const struct entry *x, bool with_file)
{
    const struct plugin *p = &r->plugin[x->plugin];
    char dims[16] = "";
    size_t n = 0;

    printf("%s: %s, of plugin %s %s\n", x->item->name, kind_label[x->kind], p->name, p->version);
    printf("  ");
    wrap(2, 2, x->item->doc);
    if (with_file)
        field("File", "%s", p->path);
    if (x->item->source[0])
        field("Source", "%s", x->item->source);
    for (int d = 1; d <= 3; d++)
        if (x->item->dims >> d & 1u)
            n += (size_t)snprintf(dims + n, sizeof(dims) - n, "%s%d", n > 0 ? ", " : "", d);
    field("Dimensions", "%s", dims);
    params_text(&x->item->params);
    props_text("Properties", &x->item->props);
    specific_text(x);
    extras_text(x);
    putchar('\n');
}

static void plugin_text(const struct plugin *p)
{
    printf("%s %s: plugin\n", p->name, p->version);
    if (p->doc[0]) {
        printf("  ");
        wrap(2, 2, p->doc);
    }
    field("File", "%s", p->path);
    if (p->license[0])
        field("License", "%s", p->license);
    field("ABI", "%u.%u", p->abi_major, p->abi_minor);
    putchar('\n');
}

static size_t widest(const struct registry *r, const struct info_choice *c)
{
    size_t most = 0;

    for (size_t i = 0; i < c->n_entry; i++) {
        const size_t n = strlen(r->entry[c->entry[i]].item->name);
        most = n > most && n <= 24 ? n : most;
    }
    return most;
}

/* They are built in. */
static void integrators_text(size_t indent)
{
    size_t n;
    const char *const *name = integrator_names(&n);

    puts("Integrators");
    for (size_t i = 0; i < n; i++)
        labelled(2, indent, name[i], integrator_find(name[i])->doc);
    putchar('\n');
}

/* A line each, by kind. */
static void list_text(const struct registry *r, const struct info_choice *c)
{
    static const char *const title[KIND_COUNT] = {
        "Functions", "Equations of state", "Boundary conditions", "Kernels",
        "Schemes",   "Exact solutions"};
    const size_t indent = widest(r, c) + 4;

    for (int kind = 0; kind < KIND_COUNT; kind++) {
        bool any = false;
        for (size_t i = 0; i < c->n_entry; i++) {
            const struct entry *x = &r->entry[c->entry[i]];
            if ((int)x->kind != kind)
                continue;
            if (!any)
                puts(title[kind]);
            any = true;
            labelled(2, indent, x->item->name, x->item->doc);
        }
        if (any)
            putchar('\n');
    }
    integrators_text(indent);
    puts(c->n_plugin > 0 ? "Plugins" : "No plugin was found.");
    for (size_t i = 0; i < c->n_plugin; i++) {
        const struct plugin *p = &r->plugin[c->plugin[i]];
        labelled(2, indent, p->name, p->doc);
        printf("%*s%s, ABI %u.%u, %s\n", (int)indent, "", p->version, p->abi_major, p->abi_minor,
               p->path);
    }
    if (c->n_plugin > 0)
        puts("\n`sph info NAME' tells all that a plugin or an item declares.");
}

void info_text(const struct registry *r, const struct info_choice *c)
{
    if (!c->detail) {
        list_text(r, c);
        return;
    }
    for (size_t i = 0; i < c->n_plugin; i++)
        plugin_text(&r->plugin[c->plugin[i]]);
    for (size_t i = 0; i < c->n_entry; i++)
        entry_text(r, &r->entry[c->entry[i]], c->n_plugin == 0);
}

void info_extensions(void)
{
    for (size_t i = 0; i < n_extension; i++)
        labelled(0, 20, extension[i].id, extension[i].doc);
}
