/* base/place.h -- where the folders of this installation are, also after its tree was moved. Asks
 * the file system where the program's file lies and which folders there are. */
#ifndef BASE_PLACE_H
#define BASE_PLACE_H

/* The folder of shared data ($(datadir)/sph: templates, examples) and that of the plugins
 * ($(libdir)/sph/plugins-N), in fresh memory; NULL when out of memory. The one beside the program,
 * if there is such a folder, else the one that configure was told; whether that exists is for the
 * caller to see. [main] */
char *place_data(void);
char *place_plugins(void);

/* The same of any absolute folder that configure was told. */
char *place_of(const char *folder);

/* Where `folder` comes to lie, in fresh memory, if the program's folder, told to be `bindir`, is in
 * truth `here`: what the two have in common is the part that moved. NULL if `here` does not end as
 * bindir does, so that it is none of a moved tree, as the folder of a build; or out of memory. */
char *place_moved(const char *folder, const char *bindir, const char *here);

#endif
