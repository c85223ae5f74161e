/* Paths of files from hosts and users. A path that does not fit into its buffer becomes empty. */
#ifndef PATHS_H
#define PATHS_H

#include <stddef.h>

/* Find the folder of resources from what a host passes: a URI (file:///a%20b, file:///C:/a), a path, or NULL. */
void path_of_resources(const char *location, char folder[], size_t size);

/* Join a folder and a file name; an absolute name (/a, \a, C:\a) or an empty folder leaves the name as it is. */
void path_in_folder(const char *folder, const char *name, char path[], size_t size);

#endif
