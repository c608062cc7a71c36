/* registry/crash.h -- a plugin whose code crashes while it is loaded or closed ends the program, since
 * nothing can be said of its memory then; but it does not end without a sentence. */
#ifndef REGISTRY_CRASH_H
#define REGISTRY_CRASH_H

/* From now on a crash is the plugin's: it is told on stderr as "plugin PATH: it crashed (segmentation
 * fault) while it was WHAT", and the program ends with EXIT_REFUSED. A signal that somebody else
 * watches (a sanitizer, MPI, the plugin checker) is left to him. `path` and `what` live until
 * crash_forget. Calls do not nest. [main] */
void crash_watch(const char *path, const char *what);
void crash_forget(void);

#endif
