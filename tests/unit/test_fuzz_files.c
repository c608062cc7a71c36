/* test_fuzz_files.c -- plugin files that are cut off or have flipped bits: each is refused with
 * one sentence, or loads; the program never ends without a sentence. What the preflight lets pass
 * is loaded by a child, whose fate is counted, by the part of the file that the bit lies in.
 *
 * Held to zero: every end but REFUSED and LOADED after a change of headers, segments, sections, the
 * dynamic section, hash tables, symbols, strings, versions or relocations. Two numbers in these are
 * beyond any look at the file, as data are: the address of an exported symbol and the addend of a
 * relocation, changed into another address of the same segment. There the plugin's crash may be
 * TOLD (registry/crash.h), and what is held to zero is an end without a word. Changed code is only looked at: running it could do anything. With
 * SPH_FUZZ_ALL set every bit of the file is flipped, else a part of them. */
#include "config.h"

#include "registry/loader.h"
#include "registry/preflight.h"

#include <elf.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static pid_t parent;
static char folder[] = "/tmp/sph-fuzz-XXXXXX";
static char file[64], words[64]; /* the plugin; what the child says */
static unsigned char *good;
static size_t n_good;

/* -- Parts of the file -------- */

enum part {
    HEADER,
    SEGMENTS,
    SECTIONS,
    DYNAMIC,
    HASH,
    SYMBOLS,
    STRINGS,
    VERSIONS,
    RELOCATIONS,
    ADDRESSES, /* st_value, st_size, r_addend */
    REST,
    CODE, /* never loaded */
    PARTS
};
static const char *const part_name[PARTS] = {
    "header",  "segments", "sections",    "dynamic section", "hash tables",  "symbols",
    "strings", "versions", "relocations", "addresses",       "data, unused", "code"};

static ElfW(Ehdr) header(void)
{
    ElfW(Ehdr) h;

    memcpy(&h, good, sizeof(h));
    return h;
}

static ElfW(Shdr) section(unsigned i)
{
    ElfW(Shdr) s;

    memcpy(&s, good + header().e_shoff + i * sizeof(s), sizeof(s));
    return s;
}

static enum part part_of_section(const ElfW(Shdr) * s, size_t at)
{
    switch (s->sh_type) {
    case SHT_DYNAMIC:
        return DYNAMIC;
    case SHT_HASH:
    case SHT_GNU_HASH:
        return HASH;
    case SHT_DYNSYM:
        at = (at - s->sh_offset) % sizeof(ElfW(Sym));
        return (at >= offsetof(ElfW(Sym), st_value) &&
                at < offsetof(ElfW(Sym), st_value) + sizeof(ElfW(Addr))) ||
                       (at >= offsetof(ElfW(Sym), st_size) &&
                        at < offsetof(ElfW(Sym), st_size) + sizeof(((ElfW(Sym) *)0)->st_size))
                   ? ADDRESSES
                   : SYMBOLS;
    case SHT_STRTAB:
        return s->sh_flags & SHF_ALLOC ? STRINGS : REST;
    case SHT_GNU_versym:
    case SHT_GNU_verneed:
    case SHT_GNU_verdef:
        return VERSIONS;
    case SHT_RELA:
        at = (at - s->sh_offset) % sizeof(ElfW(Rela));
        return at >= offsetof(ElfW(Rela), r_addend) ? ADDRESSES : RELOCATIONS;
    case SHT_REL:
    case SHT_RELR:
        return RELOCATIONS;
    default:
        return s->sh_flags & SHF_EXECINSTR ? CODE : REST;
    }
}

static enum part part_of(size_t at)
{
    const ElfW(Ehdr) h = header();

    if (at < sizeof(h))
        return HEADER;
    if (at >= h.e_phoff && at < h.e_phoff + (size_t)h.e_phnum * sizeof(ElfW(Phdr)))
        return SEGMENTS;
    if (at >= h.e_shoff && at < h.e_shoff + (size_t)h.e_shnum * sizeof(ElfW(Shdr)))
        return SECTIONS;
    for (unsigned i = 0; i < h.e_shnum; i++) {
        const ElfW(Shdr) s = section(i);
        if (s.sh_type != SHT_NOBITS && at >= s.sh_offset && at < s.sh_offset + s.sh_size)
            return part_of_section(&s, at);
    }
    return REST;
}

/* -- Files -------- */

static void read_good(const char *name)
{
    const char *build = getenv("top_builddir");
    char path[4096];
    struct stat st;
    FILE *f;

    free(good);
    snprintf(path, sizeof(path), "%s/%s", build ? build : ".", name);
    f = fopen(path, "rb");
    if (!f || fstat(fileno(f), &st))
        fail_msg("cannot open %s", path);
    n_good = (size_t)st.st_size;
    good = malloc(n_good);
    assert_non_null(good);
    assert_int_equal(fread(good, 1, n_good, f), n_good);
    fclose(f);
}

static void write_file(size_t n)
{
    const int fd = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644);

    if (fd < 0)
        fail_msg("%s: %s", file, strerror(errno));
    assert_int_equal(write(fd, good, n), n);
    assert_int_equal(close(fd), 0);
}

static int setup(void **state)
{
    (void)state;
    parent = getpid();
    if (!mkdtemp(folder))
        return -1;
    snprintf(file, sizeof(file), "%s/changed.so", folder);
    snprintf(words, sizeof(words), "%s/words", folder);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    if (getpid() != parent)
        _exit(1); /* a child that went astray */
    free(good);
    remove(file);
    remove(words);
    return remove(folder);
}

/* One line of printable text that names the file. */
static bool is_sentence(const struct error *e)
{
    for (const char *s = e->text; *s; s++)
        if ((unsigned char)*s < 0x20 || *s == 0x7f)
            return false;
    return e->exit_code == EXIT_REFUSED && strlen(e->text) > 10;
}

/* -- Loading in a child -------- */

enum fate { LOADED, REFUSED, SPEECHLESS, TOLD = EXIT_REFUSED, ENDED };

static void child(void)
{
    const struct rlimit no_core = {0, 0};
    struct registry r;
    struct error e = {0};
    enum fate fate = LOADED;

    setrlimit(RLIMIT_CORE, &no_core);
    for (int s = 1; s < 32; s++)
        signal(s, SIG_DFL);
    alarm(20);
    if (!freopen(words, "w", stderr) || registry_init(&r, &e))
        _exit(SPEECHLESS);
    if (loader_load(&r, file, &e))
        fate = is_sentence(&e) && r.n_plugin == 0 && r.n_entry == 0 ? REFUSED : SPEECHLESS;
    registry_fini(&r);
    _exit((int)fate);
}

/* The child left with EXIT_REFUSED: did it say why, in one line that names the file? */
static bool crash_is_told(void)
{
    char text[4096];
    FILE *f = fopen(words, "r");
    const size_t n = f ? fread(text, 1, sizeof(text) - 1, f) : 0;

    if (f)
        fclose(f);
    text[n] = '\0';
    return strncmp(text, "sph: plugin ", 12) == 0 && strstr(text, file) &&
           strstr(text, ": it crashed (") && n > 0 && strchr(text, '\n') == text + n - 1;
}

static enum fate load_in_child(void)
{
    int status = 0;
    const pid_t pid = fork();

    assert_true(pid >= 0);
    if (pid == 0)
        child();
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (!WIFEXITED(status) || WEXITSTATUS(status) > TOLD)
        return ENDED;
    return WEXITSTATUS(status) == TOLD && !crash_is_told() ? ENDED : (enum fate)WEXITSTATUS(status);
}

/* -- The tests -------- */

struct count {
    unsigned flips, loaded, refused, told, ended;
};

static void flip(size_t at, unsigned bit, bool load, struct count *c)
{
    struct error e = {0};
    enum fate fate = REFUSED;

    good[at] = (unsigned char)(good[at] ^ 1u << bit);
    write_file(n_good);
    if (preflight_file(file, &e)) {
        if (!is_sentence(&e))
            fail_msg("byte %zu, bit %u: %s", at, bit, e.text);
    } else if (load) {
        fate = load_in_child();
        if (fate == SPEECHLESS)
            fail_msg("byte %zu, bit %u: refused without a sentence", at, bit);
        if (fate == ENDED || (fate == TOLD && part_of(at) < ADDRESSES))
            printf("ended by %s: byte %zu, bit %u\n", part_name[part_of(at)], at, bit);
    } else {
        fate = LOADED;
    }
    good[at] = (unsigned char)(good[at] ^ 1u << bit);
    c->flips++;
    c->loaded += fate == LOADED;
    c->refused += fate == REFUSED;
    c->told += fate == TOLD;
    c->ended += fate == ENDED;
}

/* Every how many bits one is flipped. */
static size_t pace(enum part part)
{
    if (getenv("SPH_FUZZ_ALL"))
        return 1;
    return part >= REST ? 61 : part == SECTIONS ? 13 : part == ADDRESSES ? 7 : 5;
}

static void flip_bits_of(const char *name, unsigned coarser)
{
    struct count count[PARTS] = {{0, 0, 0, 0, 0}};
    size_t seen[PARTS] = {0};
    unsigned total = 0, held = 0;
    /* A sanitizer's own tables are in the data: what it makes of changed ones is its affair. */
    const char *sanitized = getenv("SPH_SANITIZED");
    const bool load = !sanitized || sanitized[0] == '\0';

    read_good(name);
    printf("%s: %zu bytes\n", name, n_good);
    for (size_t at = 0; at < n_good; at++)
        for (unsigned bit = 0; bit < 8; bit++) {
            const enum part part = part_of(at);
            if (seen[part]++ % (pace(part) * coarser) == 0)
                flip(at, bit, load && part != CODE, &count[part]);
        }
    for (int p = 0; p < PARTS; p++) {
        printf("%-20s %6u flips: %6u refused, %6u loaded, %3u crashed and told, %3u ended\n",
               part_name[p], count[p].flips, count[p].refused, count[p].loaded, count[p].told,
               count[p].ended);
        total += count[p].flips;
        held += count[p].ended + (p < ADDRESSES ? count[p].told : 0);
    }
    printf("%u flips, each %s\n", total,
           load ? "loaded where it was neither refused nor of code" : "looked at");
    assert_int_equal(held, 0);
    assert_true(total >= 1000);
}

static void flipped_bits(void **state)
{
    (void)state;
    flip_bits_of("tests/abi/.libs/good.so", 1);
}

/* One that needs libraries, with versions of their symbols. */
static void flipped_bits_of_a_larger_one(void **state)
{
    (void)state;
    flip_bits_of("plugins/.libs/exact.so", getenv("SPH_FUZZ_ALL") ? 1 : 3);
}

static void cut_off(void **state)
{
    const size_t step = getenv("SPH_FUZZ_ALL") ? 1 : 17;

    (void)state;
    read_good("tests/abi/.libs/good.so");
    for (size_t n = 0; n < n_good; n += n < 2048 || n + 256 > n_good ? 1 : step) {
        struct error e = {0};
        write_file(n);
        if (preflight_file(file, &e) == 0)
            fail_msg("accepted with %zu of %zu bytes", n, n_good);
        assert_true(is_sentence(&e));
    }
    write_file(n_good);
    assert_int_equal(load_in_child(), LOADED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(cut_off), cmocka_unit_test(flipped_bits),
                                       cmocka_unit_test(flipped_bits_of_a_larger_one)};

    return cmocka_run_group_tests(tests, setup, teardown);
}
