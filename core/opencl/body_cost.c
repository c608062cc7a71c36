/* opencl/body_cost.c -- counts operations in a body's text (see body_cost.h). Not a compiler: it knows operators,
 * the words of lanes.h, and for-loops of the form that bodies have, `for (int c = 0; c < DIM; c++)`. */
#include "opencl/body_cost.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH 32 /* of loops within each other; deeper ones count once */

static const struct {
    const char *name;
    double flops;
} words[] = {
    {"sph_add", 1},        {"sph_sub", 1},  {"sph_sqrt", 1}, {"sph_rsqrt", 2}, {"sqrt", 1},
    {"sph_w", 8},          {"sph_dw", 8},   {"sph_dw_q", 8}, {"sph_grad", 12}, {"sph_ipow", 3},
    {"sph_exp", 15},       {"sph_log", 15}, {"sph_pow", 30}, {"exp", 15},      {"log", 15},
    {"pow", 30},           {"sph_min", 1},  {"sph_max", 1},  {"fmin", 1},      {"fmax", 1},
    {"sph_pow_where", 30},
};

struct count {
    const char *at;
    int dim;
    double flops;
    struct {
        double times;       /* of all loops around, this one's included */
        int braces, parens; /* where it ends; braces -1: with its only statement */
    } loop[DEPTH];
    int n_loop, braces, parens;
    bool operand; /* what stood before is one, so that a sign is an operator */
};

static const char *skip_comment(const char *s)
{
    const char *end;

    if (s[0] == '/' && s[1] == '*') {
        end = strstr(s + 2, "*/");
        return end ? end + 2 : s + strlen(s);
    }
    return s + strcspn(s, "\n"); /* "//", "#" */
}

/* What a loop's condition says: "c < DIM", "n <= 4". */
static double times_of(const char *condition, size_t n, int dim)
{
    const char *less = memchr(condition, '<', n);
    double times = 1.0;
    char text[64];

    if (!less)
        return 1.0;
    const bool last = less[1] == '=';
    n -= (size_t)(less + 1 + last - condition);
    n = n < sizeof(text) - 1 ? n : sizeof(text) - 1;
    memcpy(text, less + 1 + last, n);
    text[n] = '\0';
    for (const char *s = text; *s;) {
        char *end = NULL;
        const double number = strtod(s, &end);
        if (strncmp(s, "DIM", 3) == 0) {
            times *= dim;
            s += 3;
        } else if (end > s) {
            times *= number;
            s = end;
        } else {
            s++;
        }
    }
    return times + (last ? 1.0 : 0.0);
}

static double times(const struct count *c)
{
    return c->n_loop ? c->loop[c->n_loop - 1].times : 1.0;
}

/* At "for": its head is read over, what follows counts so often. */
static void enter_loop(struct count *c)
{
    const char *open = strchr(c->at, '('), *first = open ? strchr(open, ';') : NULL,
               *second = first ? strchr(first + 1, ';') : NULL;
    int depth = 1;

    c->at += 3;
    if (!second || c->n_loop == DEPTH)
        return;
    const double here = times(c) * times_of(first + 1, (size_t)(second - first - 1), c->dim);
    for (c->at = open + 1; *c->at && depth > 0; c->at++)
        depth += (*c->at == '(') - (*c->at == ')');
    while (isspace((unsigned char)*c->at))
        c->at++;
    c->loop[c->n_loop].times = here;
    c->loop[c->n_loop].braces = *c->at == '{' ? c->braces : -1;
    c->loop[c->n_loop++].parens = c->parens;
    c->operand = false;
}

static void leave_statement(struct count *c)
{
    while (c->n_loop && c->loop[c->n_loop - 1].braces < 0 &&
           c->loop[c->n_loop - 1].parens == c->parens)
        c->n_loop--;
}

static void close_brace(struct count *c)
{
    c->braces--;
    if (c->n_loop && c->loop[c->n_loop - 1].braces == c->braces) {
        c->n_loop--;
        leave_statement(c);
    }
}

static void word(struct count *c)
{
    size_t n = 1;

    while (isalnum((unsigned char)c->at[n]) || c->at[n] == '_')
        n++;
    if (n == 3 && strncmp(c->at, "for", 3) == 0) {
        enter_loop(c);
        return;
    }
    for (size_t k = 0; k < sizeof(words) / sizeof(words[0]); k++)
        if (strlen(words[k].name) == n && strncmp(c->at, words[k].name, n) == 0)
            c->flops += times(c) * words[k].flops;
    c->at += n;
    c->operand = true;
}

static void symbol(struct count *c)
{
    const char s = *c->at++;

    if ((s == '+' || s == '-') && *c->at == s) {
        c->at++;
        return;
    }
    if (strchr("+-*/", s) && (c->operand || s == '/'))
        c->flops += times(c);
    c->operand = s == ')' || s == ']';
    c->parens += (s == '(') - (s == ')');
    if (s == '{')
        c->braces++;
    if (s == '}')
        close_brace(c);
    if (s == ';')
        leave_statement(c);
}

double body_flops(const char *text, int dim)
{
    struct count c = {.at = text, .dim = dim};

    while (*c.at) {
        if ((c.at[0] == '/' && (c.at[1] == '*' || c.at[1] == '/')) || c.at[0] == '#')
            c.at = skip_comment(c.at);
        else if (isspace((unsigned char)*c.at))
            c.at++;
        else if (isalpha((unsigned char)*c.at) || *c.at == '_')
            word(&c);
        else if (isdigit((unsigned char)*c.at) || *c.at == '.') {
            char *end;
            strtod(c.at, &end);
            c.at = end > c.at ? end : c.at + 1;
            c.operand = true;
        } else
            symbol(&c);
    }
    return c.flops;
}
