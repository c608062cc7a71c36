/* cli/render.c -- `sph render SNAPSHOT|FOLDER`: pictures of snapshots. */
#include "config.h"

#include "base/text.h"
#include "cli/cli.h"
#include "io/output.h"
#include "io/render.h"

#include <argp.h>
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct arguments {
    const char *path, *out;
    bool all;
    struct render_options render;
};

enum key {
    KEY_ARRAY = 256,
    KEY_MIN,
    KEY_MAX,
    KEY_LOG,
    KEY_MAP,
    KEY_SLICE,
    KEY_REGION,
    KEY_SIZE,
    KEY_ALL
};

static const struct argp_option options[] = {
    {"field", 'f', "FIELD", 0,
     "The field that is drawn: rho, v (its length), v.x (default: rho, or the first)", 0},
    {"array", KEY_ARRAY, "NAME", 0, "Only the particles of this array", 0},
    {"min", KEY_MIN, "X", 0, "Lower end of the colours, or of a graph (default: of the data)", 0},
    {"max", KEY_MAX, "X", 0, "Upper end", 0},
    {"log", KEY_LOG, NULL, 0, "Logarithmic scale", 0},
    {"map", KEY_MAP, "NAME", 0, "Colour map: viridis, magma, coolwarm or grey", 0},
    {"slice", KEY_SLICE, "Z0:Z1", 0,
     "Of a scene in 3D, the particles of this range (default: a section through the middle)", 0},
    {"region", KEY_REGION, "X0:X1[,Y0:Y1]", 0, "Part that is drawn (default: all)", 0},
    {"size", KEY_SIZE, "WxH", 0, "Pixels (default: 900 wide, as high as it takes)", 0},
    {"output", 'o', "FILE", 0,
     "The picture, or a folder for it (default: beside the snapshot, by its name)", 0},
    {"all", KEY_ALL, NULL, 0, "Of a folder, every snapshot instead of the last", 0},
    {0}};

/* A number, or nothing (NaN), up to `end`; NULL if it is neither. */
static const char *parse_number(const char *text, double *value, const char *ends)
{
    char *end;
    *value = (double)NAN;
    if (*text == '\0' || strchr(ends, *text))
        return text;
    *value = strtod(text, &end);
    return end > text && isfinite(*value) && (*end == '\0' || strchr(ends, *end)) ? end : NULL;
}

/* "A:B" */
static const char *parse_range(const char *text, double *a, double *b)
{
    text = parse_number(text, a, ":");
    return text && *text == ':' ? parse_number(text + 1, b, ",") : NULL;
}

static bool parse_region(const char *text, struct render_options *o)
{
    text = parse_range(text, &o->region_min[0], &o->region_max[0]);
    if (text && *text == ',')
        text = parse_range(text + 1, &o->region_min[1], &o->region_max[1]);
    return text && *text == '\0';
}

static bool parse_slice(const char *text, struct render_options *o)
{
    text = parse_range(text, &o->slice[0], &o->slice[1]);
    return text && *text == '\0' && !isnan(o->slice[0]) && !isnan(o->slice[1]);
}

static bool parse_size(const char *text, struct render_options *o)
{
    char *end;
    const long width = strtol(text, &end, 10);
    if (end == text || *end != 'x')
        return false;
    text = end + 1;
    const long height = strtol(text, &end, 10);
    if (end == text || *end || width < 1 || height < 1 || width > RENDER_SIZE_MOST ||
        height > RENDER_SIZE_MOST)
        return false;
    o->width = (int)width;
    o->height = (int)height;
    return true;
}

static bool parse_bound(const char *text, double *value)
{
    text = parse_number(text, value, "");
    return text && *text == '\0' && !isnan(*value);
}

static error_t parse(int key, char *arg, struct argp_state *state)
{
    struct arguments *a = state->input;
    bool good = true;
    switch (key) {
    case 'f':
        a->render.field = arg;
        break;
    case 'o':
        a->out = arg;
        break;
    case KEY_ALL:
        a->all = true;
        break;
    case KEY_ARRAY:
        a->render.array = arg;
        break;
    case KEY_MAP:
        a->render.map = arg;
        break;
    case KEY_LOG:
        a->render.log_scale = 1;
        break;
    case KEY_MIN:
        good = parse_bound(arg, &a->render.min);
        break;
    case KEY_MAX:
        good = parse_bound(arg, &a->render.max);
        break;
    case KEY_SLICE:
        good = parse_slice(arg, &a->render);
        break;
    case KEY_REGION:
        good = parse_region(arg, &a->render);
        break;
    case KEY_SIZE:
        good = parse_size(arg, &a->render);
        break;
    case ARGP_KEY_ARG:
        if (a->path)
            argp_error(state, "one snapshot or folder is enough: \"%s\" is too many", arg);
        a->path = arg;
        break;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no snapshot is given");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    for (size_t i = 0; !good && options[i].name; i++)
        if (options[i].key == key)
            argp_error(state, "--%s wants %s, not \"%s\"", options[i].name, options[i].arg, arg);
    return 0;
}

/* -- Which snapshots --------------------------------------------------------------------------- */

static bool is_folder(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

static int choose_snapshot(const struct dirent *entry)
{
    return output_is_snapshot(entry->d_name);
}

/* By number: names are padded to four digits, longer ones are later. */
static int compare_names(const struct dirent **a, const struct dirent **b)
{
    const size_t n = strlen((*a)->d_name), m = strlen((*b)->d_name);
    return n != m ? (n > m) - (n < m) : strcmp((*a)->d_name, (*b)->d_name);
}

/* Where the picture of a snapshot goes, fresh memory: beside it, or into the folder asked for. */
static char *picture_path(const char *snapshot, const struct arguments *a)
{
    if (a->out && !is_folder(a->out))
        return text_format("%s", a->out);
    const char *slash = strrchr(snapshot, '/'), *name = slash ? slash + 1 : snapshot;
    const char *dot = strrchr(name, '.'), *field = a->render.field;
    const int stem = (int)(dot && dot > name ? (size_t)(dot - name) : strlen(name));
    const bool has_field = field && !strchr(field, '/');
    if (a->out)
        return text_format("%s/%.*s%s%s.png", a->out, stem, name, has_field ? "-" : "",
                           has_field ? field : "");
    return text_format("%.*s%.*s%s%s.png", (int)(name - snapshot), snapshot, stem, name,
                       has_field ? "-" : "", has_field ? field : "");
}

static int render_one(const char *path, const struct arguments *a, struct error *e)
{
    struct snapshot s;
    if (snapshot_read(&s, path, e))
        return -1;
    char *png = picture_path(path, a);
    int result = png ? render_png(png, &s, &a->render, e) : error_memory(e, "a path", strlen(path));
    if (result == 0)
        puts(png);
    free(png);
    snapshot_free(&s);
    return result;
}

static int render_folder(const struct arguments *a, struct error *e)
{
    struct dirent **entry = NULL;
    const int n = scandir(a->path, &entry, choose_snapshot, compare_names);
    if (n < 0)
        return error_set(e, EXIT_USAGE, "cannot read %s: %s", a->path, strerror(errno));
    int result = 0;
    if (n == 0)
        result = error_set(e, EXIT_USAGE, "%s holds no snapshots (snapshot_*.vtkhdf)", a->path);
    for (int i = a->all ? 0 : n - 1; i < n && i >= 0 && result == 0; i++) {
        const size_t length = strlen(a->path);
        const bool slash = length > 0 && a->path[length - 1] == '/';
        char *path = text_format("%s%s%s", a->path, slash ? "" : "/", entry[i]->d_name);
        result = path ? render_one(path, a, e) : error_memory(e, "a path", length);
        free(path);
    }
    for (int i = 0; i < n; i++)
        free(entry[i]);
    free(entry);
    return result;
}

int cli_render(int argc, char **argv)
{
    static const struct argp argp = {
        .options = options,
        .parser = parse,
        .args_doc = "SNAPSHOT|FOLDER",
        .doc = "Draws a snapshot, or the last one of a folder, as PNG; prints the picture's path."};
    struct arguments a = {0};
    struct error e = {0};
    int result;
    render_defaults(&a.render);
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    if (!is_folder(a.path))
        result = render_one(a.path, &a, &e);
    else if (a.all && a.out && !is_folder(a.out))
        result = error_set(&e, EXIT_USAGE, "--all wants a folder for its pictures, and %s is none",
                           a.out);
    else
        result = render_folder(&a, &e);
    return result ? cli_error(&e) : EXIT_DONE;
}
