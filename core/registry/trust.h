/* registry/trust.h -- who could have put a plugin where it is? Owners and modes of a file, of
 * every folder and of every symbolic link on the way to it. */
#ifndef REGISTRY_TRUST_H
#define REGISTRY_TRUST_H

#include "base/error.h"
#include <sys/stat.h>

/* Follows a path to its end, as the kernel does, and looks at what it passes: the folders from
 * the root on, those of symbolic links and those of their targets. Returns the path without
 * links (the caller frees it), or NULL with a sentence that does not name the path.
 *
 * The rules are those that OpenSSH has for its users' files, with three differences:
 * - trusted are root, the user who runs, and the owner of the program itself (a cluster's
 *   software account: who could change the program need not change a plugin);
 * - a folder that others may write to passes if it is sticky (/tmp): they can add files to it,
 *   but not replace this one, and what they add is theirs, and refused for that;
 * - a group may write if nobody else can be in it: root's, or the user's own of the same name
 *   and without other members (files made with umask 002). */
char *trust_path(const char *path, struct error *e);

/* The file itself, once it is opened. */
int trust_file(const struct stat *st, struct error *e);

#endif
