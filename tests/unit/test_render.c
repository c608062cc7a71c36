/* test_render.c -- pictures: the right colours at the right places, no gaps, sizes, sentences. */
#include "config.h"

#include "io/output.h"
#include "io/render.h"
#include "io/render_parts.h"

#include "scratch.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* -- A snapshot in memory: a lattice of `side` per direction over [0, 1], f = 0 left, 1 right -- */

static struct snapshot lattice(int dim, size_t side)
{
    struct snapshot s = {.dim = dim, .time = 0.5, .n = 1, .n_array = 2, .n_column = 3};
    for (int k = 0; k < dim; k++)
        s.n *= side;
    s.title = strdup("A title");
    s.units = strdup("SI");
    s.scene_text = strdup("");
    s.x_unit = strdup("m");
    s.array_name = calloc(5000, sizeof *s.array_name);
    s.array_name[0] = strdup("fluid");
    s.array_name[1] = strdup("wall");
    s.array = calloc(s.n, sizeof *s.array);
    s.x = calloc(s.n, 3 * sizeof *s.x);
    s.column = calloc(s.n_column, sizeof *s.column);
    s.column[0] =
        (struct snapshot_column){strdup("f"), strdup("kg/m^d"), strdup("a field"), 1, NULL};
    s.column[1] = (struct snapshot_column){strdup("v"), strdup("m/s"), strdup("velocity"), 3, NULL};
    s.column[2] = (struct snapshot_column){strdup("gone"), strdup(""), strdup(""), 1, NULL};
    for (size_t c = 0; c < s.n_column; c++)
        s.column[c].value = calloc(s.n, s.column[c].ncomp * sizeof(double));
    for (size_t i = 0; i < s.n; i++) {
        for (size_t k = 0, rest = i; k < (size_t)dim; k++, rest /= side)
            s.x[3 * i + k] = ((double)(rest % side) + 0.5) / (double)side;
        s.column[0].value[i] = s.x[3 * i] > 0.5;
        s.column[1].value[3 * i] = s.x[3 * i] - 0.5;
        s.column[2].value[i] = (double)NAN;
        s.array[i] = s.x[3 * i] > 0.8;
    }
    return s;
}

/* -- The picture read back --------------------------------------------------------------------- */

struct image {
    cairo_surface_t *surface;
    int width, height;
};

static struct image image_of(void **state, const struct snapshot *s, const struct render_options *o)
{
    struct error e = {0};
    const char *path = scratch_path(state, "a.png");
    if (render_png(path, s, o, &e))
        fail_msg("%s", e.text);
    struct image i = {.surface = cairo_image_surface_create_from_png(path)};
    assert_int_equal(cairo_surface_status(i.surface), CAIRO_STATUS_SUCCESS);
    i.width = cairo_image_surface_get_width(i.surface);
    i.height = cairo_image_surface_get_height(i.surface);
    return i;
}

static uint32_t pixel(const struct image *i, int x, int y)
{
    const unsigned char *row = cairo_image_surface_get_data(i->surface) +
                               (ptrdiff_t)y * cairo_image_surface_get_stride(i->surface);
    uint32_t value;
    memcpy(&value, row + 4 * x, sizeof value);
    return value & 0xffffff;
}

static uint32_t packed(const unsigned char rgb[3])
{
    return (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
}

struct patch {
    int n, left, right, top, bottom;
};

static int apart(uint32_t a, uint32_t b)
{
    int sum = 0;
    for (int shift = 0; shift < 24; shift += 8)
        sum += abs((int)(a >> shift & 255) - (int)(b >> shift & 255));
    return sum;
}

/* Where the picture has a colour, or nearly. The colour bar may have it too: not beyond `right`. */
static struct patch patch_near(const struct image *i, uint32_t colour, int right, int tolerance)
{
    struct patch p = {0, i->width, 0, i->height, 0};
    for (int y = 0; y < i->height; y++)
        for (int x = 0; x < right; x++)
            if (apart(pixel(i, x, y), colour) <= tolerance) {
                p.n++;
                p.left = x < p.left ? x : p.left;
                p.right = x > p.right ? x : p.right;
                p.top = y < p.top ? y : p.top;
                p.bottom = y > p.bottom ? y : p.bottom;
            }
    return p;
}

static struct patch patch_of(const struct image *i, uint32_t colour, int right)
{
    return patch_near(i, colour, right, 0);
}

static struct render_options defaults(const char *field)
{
    struct render_options o;
    render_defaults(&o);
    o.field = field;
    return o;
}

static void colours_the_plane(void **state)
{
    struct snapshot s = lattice(2, 40);
    struct render_options o = defaults("f");
    struct colour_map map;
    struct error e = {0};
    assert_int_equal(colour_map_make(&map, NULL, &e), 0);
    const struct image i = image_of(state, &s, &o);
    assert_int_equal(i.width, 900);
    const struct patch low = patch_of(&i, packed(map.rgb[0]), 700);
    const struct patch high = patch_of(&i, packed(map.rgb[COLOURS - 1]), 700);
    /* Side by side, equally high, whole: not a gap in either. */
    assert_in_range(low.right - low.left, 200, 400);
    assert_in_range(low.n, (low.right - low.left - 4) * (low.bottom - low.top - 4),
                    i.width * i.height);
    assert_in_range(high.left - low.right, 0, 3);
    assert_in_range(abs(high.top - low.top), 0, 2);
    /* A square is square. */
    const struct patch both = {0, low.left, 2 * low.right - low.left, low.top, low.bottom};
    assert_in_range(abs((both.right - both.left) - (both.bottom - both.top)), 0, 12);
    cairo_surface_destroy(i.surface);

    /* The half of one array alone, all in one colour; and a part of the region. */
    o.array = "wall";
    const struct image wall = image_of(state, &s, &o);
    assert_int_equal(patch_of(&wall, packed(map.rgb[COLOURS / 2]), 200).n > 1000, true);
    cairo_surface_destroy(wall.surface);
    o.array = NULL;
    o.region_min[0] = 0.6;
    o.region_max[0] = 0.7;
    o.region_min[1] = 0.6;
    o.region_max[1] = 0.7;
    o.min = 0;
    o.max = 2;
    const struct image part = image_of(state, &s, &o);
    const struct patch white = patch_of(&part, 0xffffff, part.width);
    assert_in_range(white.n, 0, part.width * part.height / 2);
    assert_in_range(patch_of(&part, packed(colour_of(&map, 0.5)), 700).n, 200000, 600000);
    cairo_surface_destroy(part.surface);
    snapshot_free(&s);
}

static void closes_gaps_and_keeps_edges(void **state)
{
    /* Squeezed to a quarter along y: the rows lie close, the columns far apart. */
    struct snapshot s = lattice(2, 20);
    struct render_options o = defaults("f");
    struct colour_map map;
    struct error e = {0};
    colour_map_make(&map, NULL, &e);
    for (size_t i = 0; i < s.n; i++)
        s.x[3 * i + 1] *= 0.25;
    const struct image i = image_of(state, &s, &o);
    const struct patch low = patch_of(&i, packed(map.rgb[0]), 700);
    assert_in_range(low.n, 95 * (low.right - low.left) * (low.bottom - low.top) / 100,
                    i.width * i.height);
    /* As high as particles lie, and half a size more on either side. */
    const double scale = (low.right - low.left) / 0.5; /* nearly: pixels of a length */
    assert_in_range(low.bottom - low.top, (int)(0.22 * scale), (int)(0.32 * scale));
    cairo_surface_destroy(i.surface);
    snapshot_free(&s);
}

static void cuts_space(void **state)
{
    struct snapshot s = lattice(3, 16);
    struct render_options o = defaults("f");
    struct colour_map map;
    struct error e = {0};
    colour_map_make(&map, NULL, &e);
    /* What lies above the section is something else: it must not be seen. */
    for (size_t i = 0; i < s.n; i++)
        if (s.x[3 * i + 2] > 0.75)
            s.column[0].value[i] = 1 - s.column[0].value[i];
    const struct image i = image_of(state, &s, &o);
    const struct patch low = patch_of(&i, packed(map.rgb[0]), 700);
    const struct patch high = patch_of(&i, packed(map.rgb[COLOURS - 1]), 700);
    assert_in_range(low.n, 150000, 300000);
    assert_in_range(high.left - low.right, 0, 4);
    cairo_surface_destroy(i.surface);
    o.slice[0] = 0.8;
    o.slice[1] = 1;
    const struct image top = image_of(state, &s, &o);
    assert_in_range(patch_of(&top, packed(map.rgb[COLOURS - 1]), 300).n, 10000, 200000);
    cairo_surface_destroy(top.surface);
    o.slice[0] = 5;
    o.slice[1] = 6;
    assert_int_equal(render_png(scratch_path(state, "b.png"), &s, &o, &e), -1);
    snapshot_free(&s);
}

static void draws_a_graph(void **state)
{
    struct snapshot s = lattice(1, 50);
    struct render_options o = defaults("v.x");
    o.width = 400;
    const struct image i = image_of(state, &s, &o);
    assert_int_equal(i.width, 400);
    assert_int_equal(i.height, 248);
    /* From the lower left to the upper right, in the colours of two arrays (the legend is
     * beyond). */
    const struct patch first = patch_near(&i, 0x0059b2, 330, 60);
    const struct patch second = patch_near(&i, 0xd65e00, 400, 60);
    assert_in_range(first.n, 50, 5000);
    assert_in_range(second.n, 20, 5000);
    assert_in_range(first.right - first.left, 150, 300);
    assert_in_range(first.bottom, 150, 230);
    assert_true(second.left > first.right - 5 && second.top <= first.top);
    cairo_surface_destroy(i.surface);
    snapshot_free(&s);
}

static void marks_its_files(void **state)
{
    struct snapshot s = lattice(2, 4);
    struct render_options o = defaults(NULL);
    size_t n;
    o.width = 300;
    o.height = 200;
    const struct image i = image_of(state, &s, &o);
    assert_int_equal(i.width, 300);
    assert_int_equal(i.height, 200);
    cairo_surface_destroy(i.surface);
    char *png = scratch_read(scratch_path(state, "a.png"), &n);
    static const char mark[] = "tEXt" OUTPUT_PNG_KEY "\0" OUTPUT_PNG_MARK;
    assert_memory_equal(png + 37, mark, sizeof mark - 1);
    free(png);
    /* So the next run knows it. */
    struct output out;
    struct error e = {0};
    assert_int_equal(output_open(&out, scratch_path(state, ""), &e), 0);
    output_close(&out);
    assert_false(scratch_exists(scratch_path(state, "a.png")));
    snapshot_free(&s);
}

static void draws_hard_cases(void **state)
{
    struct render_options o = defaults("f");
    /* One particle; all in one place; one that fled; positions that are none; a constant. */
    struct snapshot one = lattice(2, 1), same = lattice(2, 3), fled = lattice(2, 20);
    cairo_surface_destroy(image_of(state, &one, &o).surface);
    for (size_t i = 0; i < 3 * same.n; i++)
        same.x[i] = 1e-3;
    same.x[0] = INFINITY;
    cairo_surface_destroy(image_of(state, &same, &o).surface);
    fled.x[0] = 1e9;
    for (size_t i = 0; i < fled.n; i++)
        fled.column[0].value[i] = 1 + 1e-15 * (double)i;
    const struct image i = image_of(state, &fled, &o);
    struct colour_map map;
    struct error e = {0};
    colour_map_make(&map, NULL, &e);
    assert_in_range(patch_of(&i, packed(map.rgb[COLOURS / 2]), 700).n, 200000, 600000);
    cairo_surface_destroy(i.surface);
    /* Long and narrow, and as small as may be. */
    for (size_t k = 0; k < fled.n; k++)
        fled.x[3 * k + 1] *= 1e-3;
    cairo_surface_destroy(image_of(state, &fled, &o).surface);
    o.width = o.height = RENDER_SIZE_LEAST;
    cairo_surface_destroy(image_of(state, &fled, &o).surface);
    snapshot_free(&one);
    snapshot_free(&same);
    snapshot_free(&fled);
}

/* Must fail with a sentence that holds `part`, and leave nothing. */
static void refuse(void **state, const struct snapshot *s, const struct render_options *o,
                   const char *part)
{
    struct error e = {0};
    const char *path = scratch_path(state, "no.png");
    assert_int_equal(render_png(path, s, o, &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    if (!strstr(e.text, part))
        fail_msg("\"%s\" is not in: %s", part, e.text);
    assert_false(scratch_exists(path));
}

static void refuses(void **state)
{
    struct snapshot s = lattice(2, 5);
    struct render_options o = defaults("ff");
    struct error e = {0};
    refuse(state, &s, &o, "did you mean \"f\"");
    o = defaults("v.w");
    refuse(state, &s, &o, "no component \"w\"");
    o = defaults("f.y");
    refuse(state, &s, &o, "no component \"y\"");
    o = defaults("gone");
    refuse(state, &s, &o, "no value");
    o = defaults("f");
    o.array = "flud";
    refuse(state, &s, &o, "did you mean \"fluid\"");
    o = defaults("f");
    o.map = "viridi";
    refuse(state, &s, &o, "did you mean \"viridis\"");
    o = defaults("f");
    o.min = 2;
    refuse(state, &s, &o, "range");
    o = defaults("f");
    o.region_min[0] = 5;
    refuse(state, &s, &o, "region");
    o.region_max[0] = 6;
    refuse(state, &s, &o, "nothing to draw");
    o = defaults("f");
    o.width = 20;
    refuse(state, &s, &o, "20");
    o = defaults("v.y");
    o.log_scale = 1;
    refuse(state, &s, &o, "above zero");
    o = defaults("f");
    assert_int_equal(render_png("/dev/full", &s, &o, &e), -1);
    assert_int_equal(e.exit_code, EXIT_RUN);
    scratch_limit(2000);
    const int result = render_png(scratch_path(state, "no.png"), &s, &o, &e);
    scratch_limit(0);
    assert_int_equal(result, -1);
    assert_false(scratch_exists(scratch_path(state, "no.png")));
    s.n = 0;
    refuse(state, &s, &o, "no particles");
    snapshot_free(&s);
}

/* -- Parts ------------------------------------------------------------------------------------- */

/* Lightness of sRGB (CIE L*). */
static double lightness(const unsigned char rgb[3])
{
    static const double weight[] = {0.2126, 0.7152, 0.0722};
    double y = 0;
    for (int k = 0; k < 3; k++) {
        const double c = rgb[k] / 255.0;
        y += weight[k] * (c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
    }
    return y > 0.008856 ? 116 * cbrt(y) - 16 : 903.3 * y;
}

static void maps_are_ordered(void **state)
{
    static const char *const name[] = {"viridis", "magma", "grey"};
    struct colour_map map;
    struct error e = {0};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(colour_map_make(&map, name[i], &e), 0);
        for (int k = 8; k < COLOURS; k += 8)
            assert_true(lightness(map.rgb[k]) > lightness(map.rgb[k - 8]) + 0.5);
        assert_true(lightness(map.rgb[COLOURS - 1]) - lightness(map.rgb[0]) > 70);
    }
    assert_int_equal(colour_map_make(&map, "coolwarm", &e), 0);
    assert_true(map.diverging);
    for (int k = 8; k < COLOURS / 2; k += 8) {
        assert_true(lightness(map.rgb[k]) > lightness(map.rgb[k - 8]));
        assert_true(lightness(map.rgb[COLOURS - 1 - k]) > lightness(map.rgb[COLOURS - 1 - k + 8]));
    }
    assert_ptr_equal(colour_of(&map, (double)NAN), map.rgb[0]);
    assert_ptr_equal(colour_of(&map, 7), map.rgb[COLOURS - 1]);
}

static void ticks_are_round(void **state)
{
    struct ticks t;
    (void)state;
    ticks_make(&t, -0.52, 0.52, false, 6);
    assert_int_equal(t.n, 5);
    assert_string_equal(t.text[0], "−0.50");
    assert_string_equal(t.text[2], "0.00");
    ticks_make(&t, 0, 16, false, 9);
    assert_string_equal(t.text[t.n - 1], "16");
    ticks_make(&t, 0, 3.1e-7, false, 5);
    assert_string_equal(t.factor, "×10⁻⁷");
    assert_string_equal(t.text[1], "1");
    ticks_make(&t, 1e-3, 1e3, true, 8);
    assert_int_equal(t.n, 7);
    assert_string_equal(t.text[0], "0.001");
    ticks_make(&t, 1e-9, 1e9, true, 6);
    assert_in_range(t.n, 2, 10);
    ticks_make(&t, 2, 2, false, 6);
    assert_int_equal(t.n, 0);
    ticks_make(&t, -INFINITY, INFINITY, false, 6);
    assert_int_equal(t.n, 0);
    for (int k = -300; k < 300; k += 7) {
        ticks_make(&t, -1.7 * pow(10, k), 2.9 * pow(10, k), false, 7);
        assert_in_range(t.n, 3, 10);
    }
}

static void words_are_pretty(void **state)
{
    char out[64], small[6];
    (void)state;
    assert_string_equal(pretty_unit(out, sizeof out, "kg/m^d", 2), "kg/m²");
    assert_string_equal(pretty_unit(out, sizeof out, "kg/m^d", 1), "kg/m");
    assert_string_equal(pretty_unit(out, sizeof out, "kg/m^(d+1)", 3), "kg/m⁴");
    assert_string_equal(pretty_unit(out, sizeof out, "kg/m^(d-1)", 2), "kg/m");
    assert_string_equal(pretty_unit(out, sizeof out, "m^(e", 2), "m^(e");
    assert_string_equal(pretty_unit(out, sizeof out, "N*m^-2*s^12", 2), "N·m⁻²·s¹²");
    assert_string_equal(pretty_unit(out, sizeof out, "µm^", 2), "µm^");
    assert_string_equal(pretty_unit(small, sizeof small, "metres", 2), "metre");
    assert_string_equal(pretty_name("rho"), "ρ");
    assert_string_equal(pretty_name("rhos"), "rhos");
    assert_string_equal(pretty_number(out, sizeof out, -1.5e-7), "−1.5×10⁻⁷");
    assert_string_equal(pretty_number(out, sizeof out, 0.6), "0.6");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(colours_the_plane), TEST(closes_gaps_and_keeps_edges),
        TEST(cuts_space),        TEST(draws_a_graph),
        TEST(marks_its_files),   TEST(draws_hard_cases),
        TEST(refuses),           TEST(maps_are_ordered),
        TEST(ticks_are_round),   TEST(words_are_pretty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
