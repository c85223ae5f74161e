/* Samples from a CSV file; see recording.py for its format. Numbers are read independently of the locale. */
#include "recording.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#endif

/* Largest number of rows; largest sizes of a line, a number and an excerpt in messages, in bytes. */
enum { MAX_ROWS = 1000000, MAX_LINE_SIZE = 1000, MAX_NUMBER_SIZE = 60, MAX_EXCERPT = 40 };

/* Largest magnitude of a number, in its unit. */
static const double max_magnitude = 1e12;

/* Longest step, in medians of all steps. */
static const double max_gap = 10.0;

/* Shortest step in s or m: differences over a much shorter one may overflow. */
static const double min_step = 1e-6;

/* A part of a line. */
typedef struct {
    const char *begin;
    size_t length;
} slice_t;

/* Reads the lines of a file and counts them. */
typedef struct {
    const char *path;
    FILE *stream;
    long line;                    /* number of the present line */
    char text[MAX_LINE_SIZE + 2]; /* of the present line */
    const recording_columns *expected;
    size_t columns, axis_column, value_column;
    int quantity;
    char *message;
    size_t size; /* of the message */
} reader_t;

/* ---- messages ---------------------------------------------------------------------------------------------------- */

/* Write a message about a line, "expected ..., got ...", and return 0. */
static int report_error(const reader_t *reader, long line, const char *format, ...)
{
    va_list arguments;
    const int length = snprintf(reader->message, reader->size, "%s, line %ld: ", reader->path, line);
    if (length > 0 && (size_t)length < reader->size) {
        va_start(arguments, format);
        vsnprintf(reader->message + length, reader->size - (size_t)length, format, arguments);
        va_end(arguments);
    }
    return 0;
}

/* Return the begin of a text for a message. */
static const char *excerpt(slice_t slice, char text[MAX_EXCERPT + 1])
{
    size_t length = 0;
    for (; length < slice.length && length < MAX_EXCERPT; ++length) {
        const char c = slice.begin[length];
        text[length] = c >= 32 && c < 127 ? c : '?';
    }
    text[length] = '\0';
    return length > 0 ? text : "nothing";
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

/* Open a file by its name in UTF-8. */
static FILE *open_file(const char *path)
{
#ifdef _WIN32
    wchar_t wide[2048];
    return MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 2048) > 0 ? _wfopen(wide, L"rb") : NULL;
#else
    return fopen(path, "rb");
#endif
}

/* Read a line without its end. Returns 1, 0 at the end of the file, or -1 where it is too long. */
static int next_line(reader_t *reader, slice_t *line)
{
    size_t length = 0;
    int c = getc(reader->stream);
    if (c == EOF) {
        return 0;
    }
    reader->line += 1;
    for (; c != EOF && c != '\n' && length < sizeof reader->text; c = getc(reader->stream)) {
        reader->text[length++] = (char)c;
    }
    line->begin = reader->text;
    line->length = length > 0 && reader->text[length - 1] == '\r' ? length - 1 : length;
    if (length == sizeof reader->text || line->length > MAX_LINE_SIZE) {
        report_error(reader, reader->line, "expected at most %d characters, got more", (int)MAX_LINE_SIZE);
        return -1;
    }
    return 1;
}

/* Remove blanks at both ends. */
static slice_t stripped(slice_t slice)
{
    while (slice.length > 0 && (slice.begin[0] == ' ' || slice.begin[0] == '\t')) {
        slice.begin += 1;
        slice.length -= 1;
    }
    while (slice.length > 0 && (slice.begin[slice.length - 1] == ' ' || slice.begin[slice.length - 1] == '\t')) {
        slice.length -= 1;
    }
    return slice;
}

/* Take the cell before the next comma off a line; returns 0 where there is none left. Then the begin of the line is
 * NULL. */
static int next_cell(slice_t *line, slice_t *cell)
{
    if (line->begin == NULL) {
        return 0;
    }
    const char *comma = line->length > 0 ? memchr(line->begin, ',', line->length) : NULL;
    cell->begin = line->begin;
    cell->length = comma == NULL ? line->length : (size_t)(comma - line->begin);
    line->begin = comma == NULL ? NULL : comma + 1;
    line->length = comma == NULL ? 0 : line->length - cell->length - 1;
    *cell = stripped(*cell);
    return 1;
}

/* ---- header ------------------------------------------------------------------------------------------------------ */

/* Whether a cell holds a name, with or without quotes. */
static int is_named(slice_t cell, const char *name)
{
    if (cell.length >= 2 && cell.begin[0] == '"' && cell.begin[cell.length - 1] == '"') {
        cell.begin += 1;
        cell.length -= 2;
    }
    return cell.length == strlen(name) && memcmp(cell.begin, name, cell.length) == 0;
}

/* Read the names of the columns. */
static int read_header(reader_t *reader)
{
    char got[MAX_EXCERPT + 1];
    const recording_columns *expected = reader->expected;
    int axes = 0, counts[2] = {0, 0};
    slice_t line = {reader->text, 0}, header, cell;
    if (next_line(reader, &line) < 0) {
        return 0;
    }
    reader->line = 1;
    if (line.length >= 3 && memcmp(line.begin, "\xef\xbb\xbf", 3) == 0) {
        line.begin += 3;
        line.length -= 3;
    }
    header = line;
    for (reader->columns = 0; next_cell(&line, &cell); ++reader->columns) {
        if (is_named(cell, expected->axis)) {
            axes += 1;
            reader->axis_column = reader->columns;
        }
        for (int i = 0; i < 2; ++i) {
            if (expected->quantities[i] != NULL && is_named(cell, expected->quantities[i])) {
                counts[i] += 1;
                reader->value_column = reader->columns;
                reader->quantity = i;
            }
        }
    }
    if (axes == 1 && counts[0] + counts[1] == 1) {
        return 1;
    }
    if (expected->quantities[1] == NULL) {
        return report_error(reader, 1, "expected the columns %s and %s, got %s", expected->axis,
                            expected->quantities[0], excerpt(header, got));
    }
    return report_error(reader, 1, "expected the columns %s and one of %s, %s, got %s", expected->axis,
                        expected->quantities[0], expected->quantities[1], excerpt(header, got));
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

/* Return the number of digits at the begin of a text. */
static size_t digits(const char *text)
{
    return strspn(text, "0123456789");
}

/* Whether a text is a decimal number. */
static int is_number(const char *text)
{
    const char *at = text + (*text == '+' || *text == '-');
    const size_t whole = digits(at);
    size_t fraction = 0;
    at += whole;
    if (*at == '.') {
        fraction = digits(++at);
        at += fraction;
    }
    if (*at == 'e' || *at == 'E') {
        at += 1 + (at[1] == '+' || at[1] == '-');
        const size_t exponent = digits(at);
        at = exponent > 0 ? at + exponent : text;
    }
    return whole + fraction > 0 && *at == '\0';
}

/* Return the number in a cell, or NAN. strtod expects the decimal point of the host's locale. */
static double parse_number(slice_t cell)
{
    char text[MAX_NUMBER_SIZE + 1], localised[MAX_NUMBER_SIZE + 16], half[16];
    if (cell.length > MAX_NUMBER_SIZE) {
        return NAN;
    }
    memcpy(text, cell.begin, cell.length);
    text[cell.length] = '\0';
    if (strlen(text) != cell.length || !is_number(text)) {
        return NAN;
    }
    char *point = strchr(text, '.');
    if (point == NULL) {
        return strtod(text, NULL);
    }
    snprintf(half, sizeof half, "%.1f", 0.5);
    *point = '\0';
    snprintf(localised, sizeof localised, "%s%.*s%s", text, (int)strlen(half) - 2, half + 1, point + 1);
    return strtod(localised, NULL);
}

/* Read the number in a cell; `name` is that of its column. */
static int read_number(const reader_t *reader, slice_t cell, const char *name, double *value)
{
    char got[MAX_EXCERPT + 1];
    *value = parse_number(cell);
    return fabs(*value) <= max_magnitude ||
           report_error(reader, reader->line, "expected a number of up to %g either way as %s, got %s", max_magnitude,
                        name, excerpt(cell, got));
}

/* Read the position on the axis and the value of a line. */
static int read_row(const reader_t *reader, slice_t line, double *position, double *value)
{
    slice_t cell, axis_cell = {NULL, 0}, value_cell = {NULL, 0};
    size_t column = 0;
    for (; next_cell(&line, &cell); ++column) {
        axis_cell = column == reader->axis_column ? cell : axis_cell;
        value_cell = column == reader->value_column ? cell : value_cell;
    }
    if (column != reader->columns) {
        return report_error(reader, reader->line, "expected %lu columns, got %lu", (unsigned long)reader->columns,
                            (unsigned long)column);
    }
    return read_number(reader, axis_cell, reader->expected->axis, position) &&
           read_number(reader, value_cell, reader->expected->quantities[reader->quantity], value);
}

/* Make room for one more sample. */
static int reserve_row(const reader_t *reader, recording_samples *samples, size_t *room)
{
    if (samples->count < *room) {
        return 1;
    }
    if (samples->count == MAX_ROWS) {
        return report_error(reader, reader->line, "expected at most %d rows, got more", (int)MAX_ROWS);
    }
    const size_t capacity = *room < 1024 ? 1024 : *room < MAX_ROWS / 2 ? 2 * *room : MAX_ROWS;
    double *axis = realloc(samples->axis, capacity * sizeof *axis);
    samples->axis = axis != NULL ? axis : samples->axis;
    double *values = realloc(samples->values, capacity * sizeof *values);
    samples->values = values != NULL ? values : samples->values;
    *room = capacity;
    return (axis != NULL && values != NULL) ||
           report_error(reader, reader->line, "expected memory for %lu rows, got none", (unsigned long)capacity);
}

/* Read all rows; the axis rises, and only the end may have empty lines. */
static int read_rows(reader_t *reader, recording_samples *samples)
{
    slice_t line;
    long empty = 0;
    size_t room = 0;
    int found;
    while ((found = next_line(reader, &line)) > 0) {
        double position, value;
        if (stripped(line).length == 0) {
            empty = empty != 0 ? empty : reader->line;
            continue;
        }
        if (empty != 0) {
            return report_error(reader, empty, "expected no empty line but at the end, got one");
        }
        if (!read_row(reader, line, &position, &value)) {
            return 0;
        }
        if (samples->count > 0 && !(position > samples->axis[samples->count - 1])) {
            return report_error(reader, reader->line, "expected a %s above %.10g %s, got %.10g %s",
                                reader->expected->axis, samples->axis[samples->count - 1], reader->expected->unit,
                                position, reader->expected->unit);
        }
        if (!reserve_row(reader, samples, &room)) {
            return 0;
        }
        samples->axis[samples->count] = position;
        samples->values[samples->count] = value;
        samples->count += 1;
    }
    return found == 0;
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Check the number of rows and the steps between them. */
static int check_rows(const reader_t *reader, const recording_samples *samples)
{
    if (samples->count < RECORDING_MIN_ROWS) {
        return report_error(reader, reader->line, "expected at least %d rows, got %lu", (int)RECORDING_MIN_ROWS,
                            (unsigned long)samples->count);
    }
    const size_t count = samples->count - 1;
    const char *unit = reader->expected->unit;
    double *steps = malloc(count * sizeof *steps);
    if (steps == NULL) {
        return report_error(reader, reader->line, "expected memory for %lu rows, got none", (unsigned long)count);
    }
    for (size_t i = 0; i < count; ++i) {
        steps[i] = samples->axis[i + 1] - samples->axis[i];
    }
    qsort(steps, count, sizeof *steps, ascending);
    const double median = steps[(count - 1) / 2];
    free(steps);
    for (size_t i = 0; i < count; ++i) {
        const double step = samples->axis[i + 1] - samples->axis[i];
        if (step < min_step) {
            return report_error(reader, (long)i + 3, "expected a step of at least %g %s, got %.10g %s", min_step, unit,
                                step, unit);
        }
        if (step > max_gap * median) {
            return report_error(reader, (long)i + 3,
                                "expected a step of at most %g times the median of %.10g %s, got %.10g %s", max_gap,
                                median, unit, step, unit);
        }
    }
    return 1;
}

const char *recording_read(const char *path, const recording_columns *columns, recording_samples *samples,
                           char *message, size_t size)
{
    static const recording_samples none;
    reader_t reader = {path, open_file(path), 0, {0}, columns, 0, 0, 0, 0, message, size};
    int is_valid = 0, readable = 0;
    *samples = none;
    if (reader.stream != NULL) {
        is_valid = read_header(&reader) && read_rows(&reader, samples) && check_rows(&reader, samples);
        readable = !ferror(reader.stream);
        fclose(reader.stream);
    }
    if (!readable) {
        snprintf(message, size, "%s: expected a file that can be read, got none", path);
    }
    if (!is_valid || !readable) {
        recording_free(samples);
        return message;
    }
    samples->quantity = reader.quantity;
    const double first = samples->axis[0];
    for (size_t i = 0; i < samples->count; ++i) {
        samples->axis[i] = samples->axis[i] - first;
    }
    return NULL;
}

void recording_free(recording_samples *samples)
{
    static const recording_samples none;
    free(samples->axis);
    free(samples->values);
    *samples = none;
}
