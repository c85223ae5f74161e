/* Names of files as hosts and users give them. Texts that would not fit become empty. */
#ifndef PATHS_H
#define PATHS_H

#include <stddef.h>

/* The folder of resources from what a host tells: a URI (file:///a%20b, file:///C:/a), a path, or NULL. */
void path_of_resources(const char *told, char folder[], size_t size);

/* A file's path from a folder and its name; an absolute name (/a, \a, C:\a) or an empty folder leaves the name. */
void path_in_folder(const char *folder, const char *name, char path[], size_t size);

#endif
