/* opencl/body_cost.c -- counts operations in a body's text (see body_cost.h). Not a compiler: it knows operators,
 * the words of lanes.h, macros, and loops and branches of the forms that bodies have:
 * `for (int c = 0; c < DIM; c++)`, `if (limiter > 0.5)`. */
#include "opencl/body_cost.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH 32 /* of loops within each other; deeper ones count once */
#define MACROS 8 /* within each other, likewise */

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
    const struct body_text *body;
    int macros; /* that this text is within */
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

static size_t word_length(const char *s)
{
    size_t n = 0;

    while (isalnum((unsigned char)s[n]) || s[n] == '_')
        n++;
    return n;
}

/* What a macro stands for, its parameters passed over, with lines that go on joined; NULL: there is no such one.
 * The caller frees it. */
static char *macro(const struct body_text *b, const char *name, size_t n)
{
    static const char word[] = "#define ";
    const char *s = b->prelude;
    char *text;
    size_t k = 0;

    while (s && (s = strstr(s, word)) != NULL) {
        s += sizeof(word) - 1;
        s += strspn(s, " \t");
        if (word_length(s) == n && strncmp(s, name, n) == 0)
            break;
    }
    if (!s)
        return NULL;
    s += n;
    if (*s == '(')
        s += strcspn(s, ")\n");
    s += *s == ')';
    text = malloc(strlen(s) + 1);
    for (; text && *s && *s != '\n'; s++) {
        if (s[0] == '\\' && s[1] == '\n')
            s++;
        text[k++] = *s == '\n' ? ' ' : *s;
    }
    if (text)
        text[k] = '\0';
    return text;
}

/* A loop's bound, as far as it is known: a product of DIM and numbers. */
static double bound(const struct body_text *b, const char *text, int macros)
{
    double times = 1.0;

    for (const char *s = text; *s;) {
        char *end = NULL;
        const double number = strtod(s, &end);
        const size_t n = isdigit((unsigned char)*s) ? 0 : word_length(s);
        if (n == 3 && strncmp(s, "DIM", 3) == 0) {
            times *= b->dim;
        } else if (n) {
            char *body = macros < MACROS ? macro(b, s, n) : NULL;
            times *= body ? bound(b, body, macros + 1) : 1.0;
            free(body);
        } else if (end > s) {
            times *= number;
            s = end;
            continue;
        }
        s += n ? n : 1;
    }
    return times;
}

/* What a loop's condition says: "c < DIM", "n <= 4". */
static double times_of(const struct body_text *b, const char *condition, size_t n)
{
    const char *less = memchr(condition, '<', n);
    char text[64];

    if (!less)
        return 1.0;
    const bool last = less[1] == '=';
    n -= (size_t)(less + 1 + last - condition);
    n = n < sizeof(text) - 1 ? n : sizeof(text) - 1;
    memcpy(text, less + 1 + last, n);
    text[n] = '\0';
    return bound(b, text, 0) + (last ? 1.0 : 0.0);
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
    const double here = times(c) * times_of(c->body, first + 1, (size_t)(second - first - 1));
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

/* Whether "(NAME < NUMBER)" or "(NAME > NUMBER)" is known to be false. */
static bool is_false(const struct body_text *b, const char *s)
{
    s += strspn(s, " (");
    const size_t n = word_length(s);
    const char *sign = s + n + strspn(s + n, " ");
    char *end;
    const double number = *sign == '<' || *sign == '>' ? strtod(sign + 1, &end) : 0.0;

    if ((*sign != '<' && *sign != '>') || end == sign + 1 || end[strspn(end, " ")] != ')')
        return false;
    for (size_t k = 0; k < b->n_known; k++)
        if (strlen(b->known[k].name) == n && strncmp(b->known[k].name, s, n) == 0)
            return !(*sign == '<' ? b->known[k].value < number : b->known[k].value > number);
    return false;
}

/* Over a bracket and all within it. */
static const char *skip_bracket(const char *s)
{
    int depth = 0;

    do {
        if (s[0] == '/' && (s[1] == '*' || s[1] == '/')) {
            s = skip_comment(s);
            continue;
        }
        depth += (*s == '(' || *s == '{') - (*s == ')' || *s == '}');
        s += *s != '\0';
    } while (*s && depth > 0);
    return s;
}

static void skip_branch(struct count *c)
{
    c->at += strcspn(c->at, "(");
    c->at = skip_bracket(c->at);
    while (isspace((unsigned char)*c->at))
        c->at++;
    c->at = *c->at == '{' ? skip_bracket(c->at) : c->at + strcspn(c->at, ";");
    c->operand = false;
}

static double flops_of(const struct body_text *b, const char *text, int macros);

static void word(struct count *c)
{
    const char *const name = c->at;
    const size_t n = word_length(name);

    if (n == 3 && strncmp(name, "for", 3) == 0) {
        enter_loop(c);
        return;
    }
    if (n == 2 && strncmp(name, "if", 2) == 0 && is_false(c->body, name + 2)) {
        skip_branch(c);
        return;
    }
    for (size_t k = 0; k < sizeof(words) / sizeof(words[0]); k++)
        if (strlen(words[k].name) == n && strncmp(name, words[k].name, n) == 0)
            c->flops += times(c) * words[k].flops;
    char *const body = c->macros < MACROS ? macro(c->body, name, n) : NULL;
    if (body)
        c->flops += times(c) * flops_of(c->body, body, c->macros + 1);
    free(body);
    c->at += n;
    c->operand = n != 6 || strncmp(name, "return", 6) != 0;
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

static double flops_of(const struct body_text *b, const char *text, int macros)
{
    struct count c = {.at = text, .body = b, .macros = macros};

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

double body_flops(const struct body_text *b)
{
    return flops_of(b, b->text, 0);
}
