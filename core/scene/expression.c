/* scene/expression.c -- expressions by muparser's C interface. Its errors are fetched and told as
 * ours; nothing is printed. Touches nothing else. */
#include "scene/expression.h"
#include "base/text.h"
#include <math.h>
#include <muParserDLL.h>
#include <stdlib.h>
#include <string.h>

struct expression {
    muParserHandle_t parser;
    size_t n;
    bool *used;
    double *value; /* the variables: the parser reads them here */
};

/* For suggestions: muparser cannot list what it knows. */
static const char *const function_names[] = {
    "sin",  "cos",   "tan",   "asin",  "acos", "atan",  "atan2", "sinh", "cosh",
    "tanh", "asinh", "acosh", "atanh", "log2", "log10", "log",   "ln",   "exp",
    "sqrt", "sign",  "rint",  "abs",   "min",  "max",   "sum",   "avg",  "pi"};
#define N_FUNCTION (sizeof function_names / sizeof *function_names)

static double both(double a, double b)
{
    return a != 0 && b != 0;
}

static double either(double a, double b)
{
    return a != 0 || b != 0;
}

static double negate(double a)
{
    return a == 0;
}

/* With a handler of our own (that does nothing) muparser can have no reason to report anywhere. */
static void quiet(muParserHandle_t parser)
{
    (void)parser;
}

/* The name that stands at `at`, cut to the buffer. */
static void name_at(const char *at, char *out, size_t size)
{
    size_t n = 0;
    while (n + 1 < size && at[n] &&
           ((at[n] >= 'a' && at[n] <= 'z') || (at[n] >= 'A' && at[n] <= 'Z') || at[n] == '_' ||
            (n && at[n] >= '0' && at[n] <= '9'))) {
        out[n] = at[n];
        n++;
    }
    out[n] = '\0';
}

/* The parser's error as a sentence of ours. */
static int fail_parser(struct expression *x, const char *text, const char *const *names,
                       struct error *e)
{
    const char *known[64];
    char name[48] = "", hint[512];
    size_t length = strlen(text), n = 0;
    int position = mupGetErrorPos(x->parser);
    size_t at = position < 0 || (size_t)position > length ? length : (size_t)position;
    for (size_t i = 0; i < x->n && n < 64 - N_FUNCTION; i++)
        known[n++] = names[i];
    for (size_t i = 0; i < N_FUNCTION; i++)
        known[n++] = function_names[i];
    /* muparser points at an unknown name or just behind it, by version. */
    if (at < length)
        name_at(text + at, name, sizeof name);
    if (name[0]) {
        size_t i = 0;
        while (i < n && strcmp(known[i], name) != 0)
            i++;
        if (i == n)
            return error_set(e, EXIT_USAGE, "\"%s\": column %zu: unknown name \"%s\"%s", text,
                             at + 1, name, text_suggest(hint, sizeof hint, name, known, n));
    }
    if (at >= length)
        return error_set(e, EXIT_USAGE, "\"%s\": the expression ends too early", text);
    return error_set(e, EXIT_USAGE, "\"%s\": column %zu: \"%.12s\" is unexpected here", text,
                     at + 1, text + at);
}

/* What muparser would take and we do not: texts too long, and assignments. */
static int check_text(const char *text, struct error *e)
{
    size_t n = strlen(text);
    if (n == 0 || strspn(text, " \t") == n)
        return error_set(e, EXIT_USAGE, "the expression is empty");
    if (n > EXPRESSION_BYTES)
        return error_set(e, EXIT_USAGE, "an expression of %zu characters; give at most %d", n,
                         EXPRESSION_BYTES);
    for (size_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c < 0x20 || c >= 0x7f)
            return error_set(e, EXIT_USAGE,
                             "\"%s\": column %zu: a character that no expression has",
                             c < 0x20 ? "..." : text, i + 1);
        bool part = i > 0 && strchr("=<>!", text[i - 1]);
        if (c == '=' && !part && text[i + 1] != '=')
            return error_set(e, EXIT_USAGE, "\"%s\": column %zu: \"=\" assigns; \"==\" compares",
                             text, i + 1);
        if (c == '"')
            return error_set(e, EXIT_USAGE, "column %zu: a quotation mark in an expression", i + 1);
    }
    return 0;
}

static void define(struct expression *x, const char *const *names)
{
    mupSetErrorHandler(x->parser, quiet);
    mupDefineOprt(x->parser, "&", both, 2, muOPRT_ASCT_LEFT, 0);
    mupDefineOprt(x->parser, "|", either, 1, muOPRT_ASCT_LEFT, 0);
    mupDefineInfixOprt(x->parser, "!", negate, 0);
    mupDefineConst(x->parser, "pi", acos(-1));
    for (size_t i = 0; i < x->n; i++) {
        x->value[i] = 1;
        mupDefineVar(x->parser, names[i], &x->value[i]);
    }
}

static void note_used(struct expression *x, const char *const *names)
{
    int n = mupGetExprVarNum(x->parser);
    for (int k = 0; k < n; k++) {
        const char *name = NULL;
        double *address;
        mupGetExprVar(x->parser, (unsigned)k, &name, &address);
        for (size_t i = 0; name && i < x->n; i++)
            if (!strcmp(name, names[i]))
                x->used[i] = true;
    }
}

int expression_new(struct expression **out, const char *text, const char *const *names, size_t n,
                   struct error *e)
{
    *out = NULL;
    if (check_text(text, e) < 0)
        return -1;
    struct expression *x = calloc(1, sizeof *x);
    if (x) {
        x->n = n;
        x->value = calloc(n + 1, sizeof *x->value);
        x->used = calloc(n + 1, sizeof *x->used);
        x->parser = mupCreate(muBASETYPE_FLOAT);
    }
    if (!x || !x->value || !x->used || !x->parser) {
        expression_free(x);
        return error_memory(e, "an expression", sizeof *x);
    }
    define(x, names);
    int status = 0, results = 0;
    if (mupError(x->parser))
        status = error_set(e, EXIT_USAGE, "an expression's variable cannot be named so: %s",
                           mupGetErrorMsg(x->parser));
    if (!status) {
        mupSetExpr(x->parser, text);
        mupEvalMulti(x->parser, &results);
        if (mupError(x->parser))
            status = fail_parser(x, text, names, e);
        else if (results != 1)
            status = error_set(e, EXIT_USAGE, "\"%s\": %d values, not one", text, results);
    }
    if (!status)
        note_used(x, names);
    if (status < 0) {
        expression_free(x);
        return -1;
    }
    *out = x;
    return 0;
}

void expression_free(struct expression *x)
{
    if (!x)
        return;
    if (x->parser)
        mupRelease(x->parser);
    free(x->value);
    free(x->used);
    free(x);
}

double expression_at(struct expression *x, const double *values)
{
    memcpy(x->value, values, x->n * sizeof *values);
    double result = mupEval(x->parser);
    if (mupError(x->parser)) {
        mupErrorReset(x->parser);
        return NAN;
    }
    return result;
}

bool expression_uses(const struct expression *x, size_t i)
{
    return x->used[i];
}
