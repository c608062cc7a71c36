/* tests/unit/test_text.c -- the nearest word, suggestions, formatted copies, UTF-8. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/text.h"

#include <stdlib.h>
#include <string.h>

static const char *const known[] = {"fill", "fields", "material", "boundaries", "at"};
#define N_KNOWN (sizeof known / sizeof known[0])

static void finds_the_nearest(void **state)
{
    (void)state;
    assert_string_equal(text_nearest("fil", known, N_KNOWN), "fill");
    assert_string_equal(text_nearest("fill", known, N_KNOWN), "fill");
    assert_string_equal(text_nearest("field", known, N_KNOWN), "fields");
    assert_string_equal(text_nearest("materail", known, N_KNOWN), "material"); /* swapped */
    assert_string_equal(text_nearest("bondarys", known, N_KNOWN), "boundaries");
    assert_string_equal(text_nearest("ta", known, N_KNOWN), "at"); /* a swap is one edit */
    assert_null(text_nearest("xyz", known, N_KNOWN));
    assert_null(text_nearest("material", known, 0));
    assert_null(text_nearest("", known, N_KNOWN));
}

static void distance_is_bounded(void **state)
{
    static const char *const word[] = {"abcdef"};

    (void)state;
    assert_non_null(text_nearest("abcdxy", word, 1)); /* two edits of six letters */
    assert_null(text_nearest("abcxyz", word, 1));     /* three */
    assert_non_null(text_nearest("abcde", word, 1));  /* one of five: two are allowed */
    assert_null(text_nearest("abcx", word, 1));       /* three of four: two are allowed */
}

static void survives_long_words(void **state)
{
    char word[1000];
    const char *list[1] = {word};

    (void)state;
    memset(word, 'a', sizeof word - 1);
    word[sizeof word - 1] = '\0';
    assert_null(text_nearest("aaaa", list, 1));
    assert_null(text_nearest(word, known, N_KNOWN));
}

static void suggests(void **state)
{
    char out[200];

    (void)state;
    assert_string_equal(text_suggest(out, sizeof out, "fil", known, N_KNOWN),
                        " (did you mean \"fill\"?)");
    assert_string_equal(text_suggest(out, sizeof out, "qqq", known, N_KNOWN),
                        "; known are: fill, fields, material, boundaries, at");
    assert_string_equal(text_suggest(out, sizeof out, "qqq", known, 0), "");
    assert_ptr_equal(text_suggest(out, 0, "fil", known, N_KNOWN), out);
}

/* Whatever the room: within it, terminated, and no name is cut. */
static void suggestions_fit(void **state)
{
    char out[100], whole[100];

    (void)state;
    text_suggest(whole, sizeof whole, "qqq", known, N_KNOWN);
    for (size_t size = 1; size < sizeof out; size++) {
        memset(out, '#', sizeof out);
        text_suggest(out, size, "qqq", known, N_KNOWN);
        assert_true(strlen(out) < size);
        for (size_t k = size; k < sizeof out; k++) {
            assert_int_equal(out[k], '#');
        }
        if (size > strlen(whole)) {
            assert_string_equal(out, whole);
        } else if (out[0]) {
            size_t n = strlen(out);

            assert_true(n > 5);
            assert_string_equal(out + n - 5, ", ...");
            assert_memory_equal(out, whole, n - 5);
            assert_int_equal(whole[n - 5], ',');
        }
    }
    text_suggest(out, 10, "fil", known, N_KNOWN);
    assert_string_equal(out, "");
}

static void formats(void **state)
{
    char *text = text_format("%s-%03d", "a", 7);

    (void)state;
    assert_string_equal(text, "a-007");
    free(text);
    text = text_format("%5000d", 1);
    assert_int_equal(strlen(text), 5000);
    free(text);
}

static void checks_utf8(void **state)
{
    static const struct {
        const char *text;
        size_t n, bad;
    } cases[] = {
        {"", 0, SIZE_MAX},
        {"plain", 5, SIZE_MAX},
        {"a\0b", 3, SIZE_MAX},
        {"\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80", 9, SIZE_MAX},
        {"a\x80", 2, 1},    /* no first byte */
        {"ab\xC3", 3, 2},   /* cut */
        {"\xC0\xAF", 2, 0}, /* too long a form */
        {"\xE0\x80\xAF", 3, 0},
        {"\xF0\x80\x80\xAF", 4, 0},
        {"x\xED\xA0\x80", 4, 1}, /* half a surrogate pair */
        {"\xED\x9F\xBF\xEE\x80\x80", 6, SIZE_MAX},
        {"\xF4\x8F\xBF\xBF", 4, SIZE_MAX},
        {"\xF4\x90\x80\x80", 4, 0}, /* beyond the last */
        {"\xF8\x88\x80\x80\x80", 5, 0},
        {"\xC3x", 2, 0},
        {"ok\xFF", 3, 2},
    };

    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        assert_int_equal(text_invalid_utf8(cases[k].text, cases[k].n), cases[k].bad);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_nearest),   cmocka_unit_test(distance_is_bounded),
        cmocka_unit_test(survives_long_words), cmocka_unit_test(suggests),
        cmocka_unit_test(suggestions_fit),     cmocka_unit_test(formats),
        cmocka_unit_test(checks_utf8),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
