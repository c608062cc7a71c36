/* tests/unit/test_error.c -- sentences: cutting, prefixing, aliasing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/error.h"

#include <string.h>

static void sets_sentence_and_code(void **state)
{
    struct error e;

    (void)state;
    assert_int_equal(error_set(&e, EXIT_REFUSED, "plugin %s: %d", "x", 7), -1);
    assert_int_equal(e.exit_code, EXIT_REFUSED);
    assert_string_equal(e.text, "plugin x: 7");
    assert_int_equal(error_set(NULL, EXIT_RUN, "%d", 1), -1);
    assert_int_equal(error_prefix(NULL, "%d", 1), -1);
}

static void prefixes(void **state)
{
    struct error e;

    (void)state;
    error_set(&e, EXIT_USAGE, "no such file");
    assert_int_equal(error_prefix(&e, "scene %s", "a.json"), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_string_equal(e.text, "scene a.json: no such file");
}

static void takes_its_own_text(void **state)
{
    struct error e;

    (void)state;
    error_set(&e, EXIT_USAGE, "inner");
    error_set(&e, EXIT_RUN, "outer (%s)", e.text);
    assert_string_equal(e.text, "outer (inner)");
    error_prefix(&e, "before %s", e.text);
    assert_string_equal(e.text, "before outer (inner): outer (inner)");
}

static void cuts_between_characters(void **state)
{
    struct error e;
    char text[sizeof e.text + 8];

    (void)state;
    /* Characters of two bytes, moved by one: one of the two cuts would halve a character. */
    for (size_t shift = 0; shift < 4; shift++) {
        size_t n = 0;

        for (; n < shift; n++) {
            text[n] = 'a';
        }
        for (; n + 2 < sizeof text; n += 2) {
            memcpy(text + n, "\xC3\xA9", 2);
        }
        text[n] = '\0';
        error_set(&e, EXIT_RUN, "%s", text);
        n = strlen(e.text);
        assert_true(n >= sizeof e.text - 2 && n < sizeof e.text);
        assert_memory_equal(e.text, text, n);
        assert_int_equal((n - shift) % 2, 0);
        /* A prefix pushes the end out. */
        error_prefix(&e, "p");
        n = strlen(e.text);
        assert_true(n >= sizeof e.text - 2 && n < sizeof e.text);
        assert_int_equal((n - 3 - shift) % 2, 0);
    }
}

static void keeps_what_just_fits(void **state)
{
    struct error e;
    char text[sizeof e.text];

    (void)state;
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    error_set(&e, EXIT_RUN, "%s", text);
    assert_string_equal(e.text, text);
}

static void names_memory(void **state)
{
    struct error e;

    (void)state;
    assert_int_equal(error_memory(&e, "lists", 1234567890123ull), -1);
    assert_int_equal(e.exit_code, EXIT_RUN);
    assert_non_null(strstr(e.text, "1234567890123"));
    assert_non_null(strstr(e.text, "lists"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sets_sentence_and_code), cmocka_unit_test(prefixes),
        cmocka_unit_test(takes_its_own_text),     cmocka_unit_test(cuts_between_characters),
        cmocka_unit_test(keeps_what_just_fits),   cmocka_unit_test(names_memory),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
