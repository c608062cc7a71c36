/* opencl/kernels_words.c -- the words that bodies are written in, as OpenCL C: fixed texts, the scene's kernel W as
 * functions with its coefficients in them, and the bodies' own texts (see kernels_private.h). */
#include "config.h"

#include "opencl/kernels_private.h"

#include "opencl/math_text.h"

#include <ctype.h>
#include <sph/kernel-value.h>
#include <stdlib.h>
#include <string.h>

/* -- Bodies -------- */

/* Length of a comment, a string or a character at s; 0: there is none. */
static size_t aside(const char *s)
{
    size_t n = 1;

    if (s[0] == '/' && s[1] == '/')
        return strcspn(s, "\n");
    if (s[0] == '/' && s[1] == '*') {
        const char *end = strstr(s + 2, "*/");
        return end ? (size_t)(end - s) + 2 : strlen(s);
    }
    if (*s != '"' && *s != '\'')
        return 0;
    while (s[n] && s[n] != *s)
        n += s[n] == '\\' && s[n + 1] ? 2 : 1;
    return n + (s[n] == *s);
}

static bool is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* A number as the preprocessor sees it; *real: a floating one without a suffix. */
static size_t number(const char *s, bool *real)
{
    size_t n = 0;
    bool point = false, exponent = false;
    const bool hex = s[0] == '0' && (s[1] == 'x' || s[1] == 'X');

    while (
        is_word(s[n]) || s[n] == '.' ||
        ((s[n] == '+' || s[n] == '-') && n > 0 && strchr(hex ? "pP" : "eEpP", s[n - 1]) != NULL)) {
        point = point || s[n] == '.';
        exponent = exponent || strchr(hex ? "pP" : "eE", s[n]) != NULL;
        n++;
    }
    *real = (point || exponent) && !strchr(hex ? "lL" : "fFlL", s[n - 1]) &&
            !(hex && exponent && strchr("fF", s[n - 1]));
    return n;
}

/* Whether a loop that begins here is short, as over components: its head, up to the bracket that closes it, speaks
 * of DIM, or has a bound of one digit. */
static bool is_short(const char *s)
{
    int depth = 0;

    for (s += 3 + strspn(s + 3, " \t\n"); *s; s++) {
        depth += (*s == '(') - (*s == ')');
        if (depth <= 0)
            return false;
        if (strncmp(s, "DIM", 3) == 0 && !is_word(s[-1]) && !is_word(s[3]))
            return true;
        const char *bound = s + 1 + strspn(s + 1, "= ");
        if (*s == '<' && isdigit((unsigned char)*bound) && !is_word(bound[1]) && bound[1] != '.')
            return true;
    }
    return false;
}

/* OpenCL C knows no vector of floats times a double: numbers get the suffix that makes them floats. Short
 * loops are to be unrolled, so that arrays become registers: some compilers do so only if told. */
static void put_words_of(FILE *out, const char *s, bool in_floats)
{
    while (*s) {
        bool real = false;
        size_t n = aside(s);
        if (!n && (isdigit((unsigned char)*s) || (*s == '.' && isdigit((unsigned char)s[1]))))
            n = number(s, &real);
        else if (!n)
            for (n = 1; is_word(s[0]) && is_word(s[n]);)
                n++;
        if (n == 3 && strncmp(s, "for", 3) == 0 && is_short(s))
            fputs("SPH_UNROLLED ", out);
        fwrite(s, 1, n, out);
        if (real && in_floats)
            fputc('f', out);
        s += n;
    }
}

static void put_text(FILE *out, const char *text, const char *file, bool in_floats)
{
    fputs("#line 1 \"", out);
    for (const char *s = file ? file : "a body"; *s; s++)
        fprintf(out, *s == '"' || *s == '\\' ? "\\%c" : "%c", *s);
    fputs("\"\n", out);
    put_words_of(out, text, in_floats);
    fputs("\n#line 1 \"what sph wrote behind it\"\n", out);
}

void put_body(FILE *out, const char *text, const char *file, bool in_floats)
{
    if (in_floats)
        fputs("#define double float\n", out);
    fputs("{\n", out);
    put_text(out, text, file, in_floats);
    fputs("}\n", out);
    if (in_floats)
        fputs("#undef double\n", out);
}

void put_prelude(FILE *out, const char *text, const char *file, bool in_floats)
{
    if (text)
        put_text(out, text, file, in_floats);
}

/* The next macro that the text defines, or NULL; *n: its name's length. */
static const char *next_macro(const char **at, size_t *n)
{
    const char *s = *at;

    while (*s) {
        const char *line = s;
        s += strcspn(s, "\n");
        s += *s == '\n';
        line += strspn(line, " \t");
        if (*line++ != '#')
            continue;
        line += strspn(line, " \t");
        if (strncmp(line, "define", 6) != 0)
            continue;
        line += 6;
        line += strspn(line, " \t");
        for (*n = 0; is_word(line[*n]);)
            ++*n;
        *at = s;
        return line;
    }
    return NULL;
}

/* Another body may mean something else by the same names. */
void put_prelude_end(FILE *out, const char *text)
{
    const char *name;
    size_t n;

    while (text && (name = next_macro(&text, &n)) != NULL)
        fprintf(out, "#undef %.*s\n", (int)n, name);
}

/* -- The form of W -------- */

static void put_polynomial(FILE *out, const double *c, uint32_t n, double norm, uint32_t power)
{
    for (uint32_t k = 0; k + 1 < n; k++)
        fprintf(out, "(sph_num(%a) + t * ", c[k] * norm);
    fprintf(out, "sph_num(%a)", c[n - 1] * norm);
    for (uint32_t k = 0; k + 1 < n; k++)
        fputc(')', out);
    fprintf(out, " * sph_ipow(t, %u)", power);
}

static void put_place(FILE *out, const sph_kernel_piece *p, const char *q)
{
    fprintf(out, "    const R t = sph_max(sph_num(%a) - %s, sph_num(0.0));\n", p->knot, q);
}

static void put_sum(FILE *out, const sph_kernel_form *f, bool slope)
{
    fprintf(out, "SPH_FN(R, %s, (const SPH_FORM *K, R q))\n{\n", slope ? "sph_dw_" : "sph_w_");
    if (f->n_table) {
        fprintf(out, "    return SPH_CELLS(q, %a, %a, %uu, %a, %d);\n}\n", f->support, f->cells,
                f->n_table, f->norm, slope);
        return;
    }
    fputs("    R sum = sph_num(0.0);\n", out);
    for (uint32_t k = 0; k < f->n_pieces; k++) {
        const sph_kernel_piece *p = &f->piece[k];
        fputs("    {\n", out);
        put_place(out, p, "q");
        /* A derivative of power 0 does not vanish by itself past its knot. */
        fprintf(out, "    %s%s", k ? "sum += " : "sum = ",
                slope && !p->dpower ? "sph_select(t > sph_num(0.0), " : "");
        put_polynomial(out, slope ? p->d : p->c, slope ? p->dn_coef : p->n_coef, f->norm,
                       slope ? p->dpower : p->power);
        fprintf(out, "%s;\n    }\n", slope && !p->dpower ? ", sph_num(0.0))" : "");
    }
    fputs("    return sum;\n}\n", out);
}

static void put_over_q(FILE *out, const sph_kernel_form *f)
{
    double e[SPH_KERNEL_COEFS];
    const uint32_t n = f->n_pieces == 1 && !f->n_table ? sph_kernel_over_q(&f->piece[0], e) : 0;

    fputs("SPH_FN(R, sph_dw_q_, (const SPH_FORM *K, R q))\n{\n", out);
    if (n) {
        put_place(out, &f->piece[0], "q");
        fputs("    return ", out);
        put_polynomial(out, e, n, f->norm, f->piece[0].dpower);
        fputs(";\n}\n", out);
    } else {
        fputs("    return sph_select(q > sph_num(0.0), sph_dw(K, q) / q, sph_num(0.0));\n}\n", out);
    }
    /* The weight meets the powers of h first: neither waits for r. */
    fputs("SPH_FN(R, sph_grad_, (const SPH_FORM *K, R weight, R r, R hinv))\n{\n"
          "    const R scale = sph_ipow(hinv, DIM + 2);\n",
          out);
    if (n == 1) {
        put_place(out, &f->piece[0], "r * hinv");
        fprintf(out, "    return sph_ipow(t, %u) * (weight * (scale * sph_num(%a)));\n}\n",
                f->piece[0].dpower, e[0] * f->norm);
    } else {
        fputs("    return sph_dw_q(K, r * hinv) * (weight * scale);\n}\n", out);
    }
}

void put_words(struct kernel_text *t, const char *set, int width, bool floats)
{
    fprintf(t->out,
            "#undef SPH_ISA\n#undef SPH_WIDTH\n#undef SPH_F32_WORDS\n"
            "#define SPH_ISA %s\n#define SPH_WIDTH %d\n#define SPH_F32_WORDS %d\n",
            set, width, floats);
    fputs("#line 1 \"opencl/words.cl\"\n", t->out);
    fputs(words_text, t->out);
    fputs("#line 1 \"sph/lanes-math.h\"\n", t->out);
    fputs(math_text, t->out);
    fputs("#line 1 \"opencl/words_end.cl\"\n", t->out);
    fputs(words_end_text, t->out);
    fputs("#line 1 \"the kernel W\"\n", t->out);
    if (t->plan->has_kernel) {
        put_sum(t->out, &t->plan->kernel, false);
        put_sum(t->out, &t->plan->kernel, true);
        put_over_q(t->out, &t->plan->kernel);
    }
    fputs("#undef SPH_CELLS\n", t->out);
}
