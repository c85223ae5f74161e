/* Paths and URIs. */
#include "paths.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static bool is_separator(char c)
{
    return c == '/' || c == '\\';
}

/* Whether a path begins with a drive letter, as C: or, in old URIs, C|. */
static bool begins_with_drive(const char *path)
{
    return isalpha((unsigned char)path[0]) && (path[1] == ':' || path[1] == '|');
}

/* Return the value of a hexadecimal digit, or -1. */
static int hexadecimal_digit(char c)
{
    const char *digits = "0123456789abcdef";
    const char *found = c == '\0' ? NULL : strchr(digits, tolower((unsigned char)c));
    return found == NULL ? -1 : (int)(found - digits);
}

/* Decode percent encoding as in %20; other uses of % stay, and so does %00. */
static void decode(char *text)
{
    char *to = text;
    for (const char *from = text; *from != '\0'; ++from) {
        const int high = *from == '%' ? hexadecimal_digit(from[1]) : -1;
        const int low = high >= 0 ? hexadecimal_digit(from[2]) : -1;
        const bool encoded = low >= 0 && 16 * high + low > 0;
        *to++ = encoded ? (char)(16 * high + low) : *from;
        from += encoded ? 2 : 0;
    }
    *to = '\0';
}

/* Return the path in a URI after its "file:"; the name of another host stays. */
static const char *path_of_uri(const char *uri)
{
    if (strncmp(uri, "//", 2) != 0) {
        return uri;
    }
    const char *host = uri + 2;
    const size_t length = strcspn(host, "/");
    return length == 0 || (length == 9 && strncmp(host, "localhost", 9) == 0) ? host + length : uri;
}

void path_of_resources(const char *location, char folder[], size_t size)
{
    const bool is_uri = location != NULL && strncmp(location, "file:", 5) == 0;
    const char *path = location == NULL ? "" : is_uri ? path_of_uri(location + 5) : location;
    if (snprintf(folder, size, "%s", path) >= (int)size) {
        *folder = '\0';
    }
    if (is_uri) {
        decode(folder);
        if (folder[0] == '/' && begins_with_drive(folder + 1)) {
            folder[2] = ':';
            memmove(folder, folder + 1, strlen(folder));
        }
    }
}

void path_in_folder(const char *folder, const char *name, char path[], size_t size)
{
    const size_t length = strlen(folder);
    const bool absolute = length == 0 || is_separator(name[0]) || begins_with_drive(name);
    const char *separator = absolute || is_separator(folder[length - 1]) ? "" : "/";
    if (snprintf(path, size, "%s%s%s", absolute ? "" : folder, separator, name) >= (int)size) {
        *path = '\0';
    }
}
