/* Paths and URIs, see paths.h. */
#include "paths.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static bool is_separator(char c)
{
    return c == '/' || c == '\\';
}

/* Whether a path begins with the letter of a drive, as C: or, in old URIs, C|. */
static bool begins_with_drive(const char *path)
{
    return isalpha((unsigned char)path[0]) && (path[1] == ':' || path[1] == '|');
}

static int hexadecimal(char c)
{
    const char *digits = "0123456789abcdef";
    const char *found = c == '\0' ? NULL : strchr(digits, tolower((unsigned char)c));
    return found == NULL ? -1 : (int)(found - digits);
}

/* Replace %20 and its like by what they stand for; anything else that begins with % stays. */
static void decode(char *text)
{
    char *to = text;
    for (const char *from = text; *from != '\0'; ++from) {
        const int high = *from == '%' ? hexadecimal(from[1]) : -1;
        const int low = high >= 0 ? hexadecimal(from[2]) : -1;
        const bool coded = low >= 0 && 16 * high + low > 0;
        *to++ = coded ? (char)(16 * high + low) : *from;
        from += coded ? 2 : 0;
    }
    *to = '\0';
}

/* The path in a URI behind its "file:", the host's name kept where it is another machine. */
static const char *path_of_uri(const char *uri)
{
    if (strncmp(uri, "//", 2) != 0) {
        return uri;
    }
    const char *host = uri + 2;
    const size_t length = strcspn(host, "/");
    return length == 0 || (length == 9 && strncmp(host, "localhost", 9) == 0) ? host + length : uri;
}

void path_of_resources(const char *told, char folder[], size_t size)
{
    const bool is_uri = told != NULL && strncmp(told, "file:", 5) == 0;
    const char *path = told == NULL ? "" : is_uri ? path_of_uri(told + 5) : told;
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
    const bool whole = length == 0 || is_separator(name[0]) || begins_with_drive(name);
    const char *joint = whole || is_separator(folder[length - 1]) ? "" : "/";
    if (snprintf(path, size, "%s%s%s", whole ? "" : folder, joint, name) >= (int)size) {
        *path = '\0';
    }
}
