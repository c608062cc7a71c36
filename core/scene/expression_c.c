/* scene/expression_c.c -- an expression as OpenCL C: the parser's language read anew, since it gives away no
 * tree, and written with a bracket around everything. What is written is computed here as well, at some hundred
 * places, and compared with what the parser makes of them: where the two differ there is no text. */
#include "scene/expression.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODES_MOST 512
#define ARGUMENTS_MOST 8
#define DEPTH_MOST 64
#define PLACES 200

enum kind { NUMBER, VARIABLE, NEGATIVE, NOT, BINARY, CHOICE, CALL };

/* Binary operators, by what binds least; those of a rank go from left to right, powers from right to left. */
enum operator{
    OR,
    AND,
    LESS_EQUAL,
    MORE_EQUAL,
    UNEQUAL,
    EQUAL,
    LESS,
    MORE,
    PLUS,
    MINUS,
    TIMES,
    OVER,
    POWER
};
static const struct {
    const char *word;
    int rank;
    const char *c; /* of comparisons and arithmetic */
} operators[] = {
    [OR] = {"||", 1, NULL},         [AND] = {"&&", 2, NULL},     [LESS_EQUAL] = {"<=", 4, "<="},
    [MORE_EQUAL] = {">=", 4, ">="}, [UNEQUAL] = {"!=", 4, "!="}, [EQUAL] = {"==", 4, "=="},
    [LESS] = {"<", 4, "<"},         [MORE] = {">", 4, ">"},      [PLUS] = {"+", 5, "+"},
    [MINUS] = {"-", 5, "-"},        [TIMES] = {"*", 6, "*"},     [OVER] = {"/", 6, "/"},
    [POWER] = {"^", 7, NULL},
};
#define N_OPERATOR (sizeof operators / sizeof *operators)
#define RANK_SIGN 7 /* a sign is for powers and what is single, "!" for all but a choice */

static double sign_of(double a)
{
    return (double)(a > 0) - (double)(a < 0);
}

static double whole(double a)
{
    return floor(a + 0.5);
}

/* Functions of one number; those of several stand in `call`. */
static const struct {
    const char *word, *c;
    double (*f)(double);
} functions[] = {
    {"sin", "sin", sin},       {"cos", "cos", cos},       {"tan", "tan", tan},
    {"asin", "asin", asin},    {"acos", "acos", acos},    {"atan", "atan", atan},
    {"sinh", "sinh", sinh},    {"cosh", "cosh", cosh},    {"tanh", "tanh", tanh},
    {"asinh", "asinh", asinh}, {"acosh", "acosh", acosh}, {"atanh", "atanh", atanh},
    {"log2", "log2", log2},    {"log10", "log10", log10}, {"log", "log", log},
    {"ln", "log", log},        {"exp", "exp", exp},       {"sqrt", "sqrt", sqrt},
    {"abs", "fabs", fabs},     {"sign", "sign", sign_of}, {"rint", "floor(0.5 + ", whole},
};
#define N_FUNCTION (sizeof functions / sizeof *functions)
static const char *const several[] = {"min", "max", "sum", "avg", "atan2"};
#define N_SEVERAL (sizeof several / sizeof *several)

struct node {
    enum kind kind;
    size_t which; /* variable, operator, function (several: from N_FUNCTION on) */
    double value;
    size_t n;
    int child[ARGUMENTS_MOST];
};

struct reader {
    const char *at;
    const char *const *names;
    size_t n_name, n;
    int depth;
    struct node node[NODES_MOST];
};

/* -- Reading: each gives the number of its node, or -1 -------- */

static int read_choice(struct reader *r);

static void skip(struct reader *r)
{
    r->at += strspn(r->at, " \t");
}

static bool take(struct reader *r, const char *word)
{
    skip(r);
    if (strncmp(r->at, word, strlen(word)) != 0)
        return false;
    r->at += strlen(word);
    return true;
}

static int add(struct reader *r, struct node node)
{
    if (r->n == NODES_MOST)
        return -1;
    r->node[r->n] = node;
    return (int)r->n++;
}

static int read_number(struct reader *r)
{
    char *end;
    const double value = strtod(r->at, &end);

    /* No hexadecimal numbers, and none that runs into a name. */
    if (end == r->at || memchr(r->at, 'x', (size_t)(end - r->at)) || isalpha((unsigned char)*end))
        return -1;
    r->at = end;
    return add(r, (struct node){.kind = NUMBER, .value = value});
}

static int read_call(struct reader *r, size_t which)
{
    struct node node = {.kind = CALL, .which = which};

    do {
        if (node.n == ARGUMENTS_MOST)
            return -1;
        const int child = read_choice(r);
        if (child < 0)
            return -1;
        node.child[node.n++] = child;
    } while (take(r, ","));
    const bool fits = which < N_FUNCTION || strcmp(several[which - N_FUNCTION], "atan2") != 0
                          ? which >= N_FUNCTION || node.n == 1
                          : node.n == 2;
    return fits && take(r, ")") ? add(r, node) : -1;
}

static bool is(const char *word, const char *at, size_t n)
{
    return strlen(word) == n && memcmp(word, at, n) == 0;
}

static int read_name(struct reader *r)
{
    const char *at = r->at;
    size_t n = 0;

    while (isalnum((unsigned char)at[n]) || at[n] == '_')
        n++;
    r->at += n;
    if (take(r, "(")) {
        for (size_t i = 0; i < N_FUNCTION; i++)
            if (is(functions[i].word, at, n))
                return read_call(r, i);
        for (size_t i = 0; i < N_SEVERAL; i++)
            if (is(several[i], at, n))
                return read_call(r, N_FUNCTION + i);
        return -1;
    }
    for (size_t i = 0; i < r->n_name; i++)
        if (is(r->names[i], at, n))
            return add(r, (struct node){.kind = VARIABLE, .which = i});
    return is("pi", at, n) ? add(r, (struct node){.kind = NUMBER, .value = acos(-1)}) : -1;
}

static int read_single(struct reader *r)
{
    skip(r);
    if (take(r, "(")) {
        const int inside = read_choice(r);
        return take(r, ")") ? inside : -1;
    }
    if (isdigit((unsigned char)*r->at) || *r->at == '.')
        return read_number(r);
    return isalpha((unsigned char)*r->at) || *r->at == '_' ? read_name(r) : -1;
}

/* The operator of at least this rank that stands here, taken; or N_OPERATOR. "&" and "|" are ours. */
static size_t take_operator(struct reader *r, int rank)
{
    skip(r);
    for (size_t i = 0; i < N_OPERATOR; i++)
        if (operators[i].rank >= rank && take(r, operators[i].word))
            return i;
    if (rank <= operators[AND].rank && take(r, "&"))
        return AND;
    return rank <= operators[OR].rank && take(r, "|") ? OR : N_OPERATOR;
}

static int read_operators(struct reader *r, int rank);

static int read_signed(struct reader *r)
{
    const bool minus = take(r, "-"), not = !minus && strncmp(r->at, "!=", 2) != 0 && take(r, "!");

    if (!minus && !not ) {
        take(r, "+");
        return read_single(r);
    }
    const int child = ++r->depth < DEPTH_MOST ? read_operators(r, minus ? RANK_SIGN : 1) : -1;
    r->depth--;
    return child < 0
               ? -1
               : add(r, (struct node){.kind = minus ? NEGATIVE : NOT, .n = 1, .child = {child}});
}

static int read_operators(struct reader *r, int rank)
{
    int left = read_signed(r);
    size_t which;

    while (left >= 0 && (which = take_operator(r, rank)) < N_OPERATOR) {
        const int next = operators[which].rank + (which == POWER ? 0 : 1);
        const int right = ++r->depth < DEPTH_MOST ? read_operators(r, next) : -1;
        r->depth--;
        left = right < 0
                   ? -1
                   : add(r, (struct node){
                                .kind = BINARY, .which = which, .n = 2, .child = {left, right}});
    }
    return left;
}

static int read_choice(struct reader *r)
{
    int all = -1;

    if (++r->depth < DEPTH_MOST) {
        all = read_operators(r, 1);
        if (all >= 0 && take(r, "?")) {
            const int yes = read_choice(r);
            const int no = yes >= 0 && take(r, ":") ? read_choice(r) : -1;
            all = no < 0 ? -1
                         : add(r, (struct node){.kind = CHOICE, .n = 3, .child = {all, yes, no}});
        }
    }
    r->depth--;
    return all;
}

/* -- What a node is worth -------- */

static double compute(const struct reader *r, int node, const double *value);

static double call(const struct reader *r, const struct node *x, const double *value)
{
    double all = compute(r, x->child[0], value);

    if (x->which < N_FUNCTION)
        return functions[x->which].f(all);
    const size_t which = x->which - N_FUNCTION;
    for (size_t i = 1; i < x->n; i++) {
        const double next = compute(r, x->child[i], value);
        all = which == 0   ? fmin(all, next)
              : which == 1 ? fmax(all, next)
              : which == 4 ? atan2(all, next)
                           : all + next;
    }
    return which == 3 ? all / (double)x->n : all;
}

static double binary(enum operator which, double a, double b)
{
    switch (which) {
    case OR:
        return a != 0 || b != 0;
    case AND:
        return a != 0 && b != 0;
    case LESS_EQUAL:
        return a <= b;
    case MORE_EQUAL:
        return a >= b;
    case UNEQUAL:
        return a != b;
    case EQUAL:
        return a == b;
    case LESS:
        return a < b;
    case MORE:
        return a > b;
    case PLUS:
        return a + b;
    case MINUS:
        return a - b;
    case TIMES:
        return a * b;
    case OVER:
        return a / b;
    case POWER:
        return pow(a, b);
    }
    return NAN;
}

static double compute(const struct reader *r, int node, const double *value)
{
    const struct node *x = &r->node[node];

    switch (x->kind) {
    case NUMBER:
        return x->value;
    case VARIABLE:
        return value[x->which];
    case NEGATIVE:
        return -compute(r, x->child[0], value);
    case NOT:
        return compute(r, x->child[0], value) == 0;
    case BINARY:
        return binary((enum operator)x->which, compute(r, x->child[0], value),
                      compute(r, x->child[1], value));
    case CHOICE:
        return compute(r, x->child[0], value) != 0 ? compute(r, x->child[1], value)
                                                   : compute(r, x->child[2], value);
    case CALL:
        return call(r, x, value);
    }
    return NAN;
}

static bool same(double a, double b)
{
    if (isnan(a) || isnan(b))
        return isnan(a) && isnan(b);
    return a == b || fabs(a - b) <= 1e-12 * fmax(fabs(a), fabs(b));
}

/* Small and large numbers of both signs, whole ones among them. */
static bool agrees(const struct reader *r, int node, struct expression *x)
{
    double value[EXPRESSION_NAMES];
    uint64_t seed = 1;

    for (int place = 0; place < PLACES; place++) {
        for (size_t i = 0; i < r->n_name; i++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            const double unit = (double)(seed >> 11) / 9007199254740992.0 * 2.0 - 1.0;
            value[i] = place % 4 == 0   ? unit
                       : place % 4 == 1 ? floor(4.0 * unit)
                       : place % 4 == 2 ? fabs(unit)
                                        : 50.0 * unit;
        }
        if (!same(compute(r, node, value), expression_at(x, value)))
            return false;
    }
    return true;
}

/* -- Writing -------- */

static void put(FILE *out, const struct reader *r, int node, const char *prefix);

static void put_call(FILE *out, const struct reader *r, const struct node *x, const char *prefix)
{
    const size_t which = x->which - N_FUNCTION;

    if (x->which < N_FUNCTION) {
        fprintf(out, "%s(", functions[x->which].c);
        put(out, r, x->child[0], prefix);
        fputs(functions[x->which].f == whole ? "))" : ")", out);
        return;
    }
    fputc('(', out);
    for (size_t i = 0; (which < 2 || which == 4) && i + 1 < x->n; i++)
        fputs(which == 0 ? "fmin(" : which == 1 ? "fmax(" : "atan2(", out);
    for (size_t i = 0; i < x->n; i++) {
        const bool nested = which < 2 || which == 4;
        fputs(i == 0 ? "" : nested ? ", " : " + ", out);
        put(out, r, x->child[i], prefix);
        fputs(i && nested ? ")" : "", out);
    }
    fputc(')', out);
    if (which == 3)
        fprintf(out, " / %zu.0", x->n);
}

static void put_binary(FILE *out, const struct reader *r, const struct node *x, const char *prefix)
{
    const char *const c = operators[x->which].c;
    const bool logic = x->which == OR || x->which == AND, arithmetic = c && x->which >= PLUS;

    fputs(x->which == POWER ? "pow(" : arithmetic ? "" : "(double)(", out);
    put(out, r, x->child[0], prefix);
    if (logic)
        fprintf(out, " != 0.0 %s ", operators[x->which].word);
    else
        fprintf(out, c ? " %s " : ", ", c);
    put(out, r, x->child[1], prefix);
    fputs(logic ? " != 0.0)" : arithmetic ? "" : ")", out);
}

static void put(FILE *out, const struct reader *r, int node, const char *prefix)
{
    const struct node *x = &r->node[node];

    fputc('(', out);
    switch (x->kind) {
    case NUMBER:
        fprintf(out, "%a", x->value);
        break;
    case VARIABLE:
        fprintf(out, "%s%s", prefix, r->names[x->which]);
        break;
    case NEGATIVE:
        fputc('-', out);
        put(out, r, x->child[0], prefix);
        break;
    case NOT:
        fputs("(double)(", out);
        put(out, r, x->child[0], prefix);
        fputs(" == 0.0)", out);
        break;
    case BINARY:
        put_binary(out, r, x, prefix);
        break;
    case CHOICE:
        put(out, r, x->child[0], prefix);
        fputs(" != 0.0 ? ", out);
        put(out, r, x->child[1], prefix);
        fputs(" : ", out);
        put(out, r, x->child[2], prefix);
        break;
    case CALL:
        put_call(out, r, x, prefix);
        break;
    }
    fputc(')', out);
}

char *expression_c(struct expression *x, const char *text, const char *const *names, size_t n,
                   const char *prefix)
{
    struct reader *r = calloc(1, sizeof *r);
    char *c = NULL;
    size_t size;

    if (!r || n > EXPRESSION_NAMES) {
        free(r);
        return NULL;
    }
    r->at = text;
    r->names = names;
    r->n_name = n;
    const int all = read_choice(r);
    skip(r);
    if (all >= 0 && !*r->at && agrees(r, all, x)) {
        FILE *out = open_memstream(&c, &size);
        if (out) {
            put(out, r, all, prefix);
            if (fclose(out) != 0) {
                free(c);
                c = NULL;
            }
        }
    }
    free(r);
    return c;
}
