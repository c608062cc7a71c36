/* render_text.c -- numbers and names as people write them: round ticks, powers, Greek letters. */
#include "config.h"

#include "io/render_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

/* -- Powers ------------------------------------------------------------------------------------ */

static const char *const superscript[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};

/* Appends; what does not fit is left out. */
static void add(char *out, size_t size, const char *text)
{
    const size_t n = strlen(out), m = strlen(text);
    if (n + m < size)
        memcpy(out + n, text, m + 1);
}

static void add_power(char *out, size_t size, int power)
{
    char digits[16];
    snprintf(digits, sizeof digits, "%d", power);
    for (const char *c = digits; *c; c++)
        add(out, size, *c == '-' ? "⁻" : superscript[*c - '0']);
}

/* -- Ticks ------------------------------------------------------------------------------------- */

/* The smallest of 1, 2, 2.5, 5 times a power of ten that needs at most `most` ticks. */
static double round_step(double range, int most)
{
    static const double of[] = {1, 2, 2.5, 5, 10};
    const double least = range / (most > 1 ? most - 1 : 1);
    const double power = pow(10, floor(log10(least)));
    for (size_t i = 0; i < COUNT(of); i++)
        if (of[i] * power >= least * (1 - 1e-9))
            return of[i] * power;
    return 10 * power;
}

static int decimals(double step)
{
    for (int d = 0; d < 15; d++) {
        const double scaled = step * pow(10, d);
        if (fabs(scaled - round(scaled)) < 1e-6 * scaled)
            return d;
    }
    return 15;
}

static void linear_ticks(struct ticks *t, double low, double high, int most)
{
    const double step = round_step(high - low, most), largest = fmax(fabs(low), fabs(high));
    int power = (int)floor(log10(largest));
    if (power < 5 && power > -4)
        power = 0;
    if (power) {
        snprintf(t->factor, sizeof t->factor, "×10");
        add_power(t->factor, sizeof t->factor, power);
    }
    const double unit = pow(10, power);
    const int digits = decimals(step / unit);
    for (double k = ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++) {
        if (t->n == TICKS_MOST)
            break;
        t->at[t->n] = k == 0 ? 0 : k * step;
        snprintf(t->text[t->n], sizeof t->text[0], "%s%.*f", k < 0 ? "−" : "", digits,
                 fabs(k * step / unit));
        t->n++;
    }
}

static void put_power_of_ten(char *out, size_t size, int factor, int power)
{
    if (power >= -3 && power <= 4) {
        snprintf(out, size, "%.*f", power < 0 ? -power : 0, factor * pow(10, power));
        return;
    }
    out[0] = '\0';
    if (factor != 1)
        snprintf(out, size, "%d×", factor);
    add(out, size, "10");
    add_power(out, size, power);
}

/* Decades, or 1, 2, 5 in each where they are few. */
static void log_ticks(struct ticks *t, double low, double high, int most)
{
    static const int of[] = {1, 2, 5};
    const int first = (int)floor(log10(low)), last = (int)ceil(log10(high));
    const size_t each = 3 * (last - first) <= most ? 3 : 1;
    const int stride = each > 1 || last - first < most ? 1 : (last - first) / most + 1;
    for (int p = first; p <= last; p += stride)
        for (size_t i = 0; i < each && t->n < TICKS_MOST; i++) {
            const double at = of[i] * pow(10, p);
            if (at < low * (1 - 1e-9) || at > high * (1 + 1e-9))
                continue;
            t->at[t->n] = at;
            put_power_of_ten(t->text[t->n], sizeof t->text[0], of[i], p);
            t->n++;
        }
}

void ticks_make(struct ticks *t, double low, double high, bool log, int most)
{
    *t = (struct ticks){0};
    most = most < 2 ? 2 : most > TICKS_MOST - 2 ? TICKS_MOST - 2 : most;
    if (!(high > low) || !isfinite(high - low))
        return;
    if (log)
        log_ticks(t, low, high, most);
    /* Less than a decade may hold no round power, and a few steps no two round numbers. */
    for (int extra = 0; t->n < 2 && extra < 5; extra++) {
        *t = (struct ticks){0};
        linear_ticks(t, low, high, most + extra);
    }
}

/* -- Units and names --------------------------------------------------------------------------- */

/* "^d", "^(d+1)", "^(d-1)" stand for a number: how many characters they take, 0 for anything else. */
static int dimension_power(const char *text, int dim, int *power)
{
    int taken = 0, more = 0;
    *power = dim;
    if (strncmp(text, "^d", 2) == 0)
        return 2;
    if (sscanf(text, "^(d%2d)%n", &more, &taken) == 1 && taken > 0) {
        *power = dim + more;
        return taken;
    }
    return 0;
}

const char *pretty_unit(char *out, size_t size, const char *unit, int dim)
{
    out[0] = '\0';
    for (const char *c = unit; *c;) {
        char *end = NULL;
        int power = 0;
        const int skipped = dimension_power(c, dim, &power);
        if (skipped) {
            if (power != 1)
                add_power(out, size, power);
            c += skipped;
        } else if (*c == '^' && (strtol(c + 1, &end, 10), end > c + 1 && end < c + 6)) {
            add_power(out, size, (int)strtol(c + 1, NULL, 10));
            c = end;
        } else if (*c == '*') {
            add(out, size, "·");
            c++;
        } else {
            char one[8] = {*c++};
            for (size_t k = 1; k < 4 && ((unsigned char)*c & 0xC0) == 0x80; k++)
                one[k] = *c++;
            add(out, size, one);
        }
    }
    return out;
}

const char *pretty_name(const char *name)
{
    static const char *const greek[][2] = {
        {"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"}, {"delta", "δ"},  {"epsilon", "ε"},
        {"eta", "η"},   {"theta", "θ"}, {"kappa", "κ"}, {"lambda", "λ"}, {"mu", "μ"},
        {"nu", "ν"},    {"rho", "ρ"},   {"sigma", "σ"}, {"tau", "τ"},    {"phi", "φ"},
        {"chi", "χ"},   {"psi", "ψ"},   {"omega", "ω"}};
    for (size_t i = 0; i < COUNT(greek); i++)
        if (strcmp(greek[i][0], name) == 0)
            return greek[i][1];
    return name;
}

const char *pretty_number(char *out, size_t size, double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.4g", value);
    char *power = strchr(text, 'e');
    if (power)
        *power++ = '\0';
    out[0] = '\0';
    add(out, size, text[0] == '-' ? "−" : "");
    add(out, size, text + (text[0] == '-'));
    if (power) {
        add(out, size, "×10");
        add_power(out, size, atoi(power));
    }
    return out;
}
