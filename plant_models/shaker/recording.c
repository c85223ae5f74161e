/* Samples from a CSV file; its form is described in recording.py. Numbers are read whatever the locale. */
#include "recording.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#endif

enum { MOST_ROWS = 1000000, LONGEST_LINE = 1000, LONGEST_NUMBER = 60, LONGEST_SHOWN = 40 };

static const double largest = 1e12;
static const double widest_gap = 10.0;
static const double shortest_step = 1e-6;

/* A piece of a line. */
typedef struct {
    const char *begin;
    size_t length;
} piece_t;

/* A file, its lines counted, and where a line has what. */
typedef struct {
    const char *path;
    FILE *stream;
    long line;
    char text[LONGEST_LINE + 2];
    size_t columns, time_column, value_column;
    int of_acceleration;
    char *message;
    size_t size;
} reader_t;

/* ---- messages ---------------------------------------------------------------------------------------------------- */

/* Say what is wrong with a line, as "expected ..., got ...", and return 0. */
static int wrong(const reader_t *it, long line, const char *format, ...)
{
    va_list arguments;
    const int length = snprintf(it->message, it->size, "%s, line %ld: ", it->path, line);
    if (length > 0 && (size_t)length < it->size) {
        va_start(arguments, format);
        vsnprintf(it->message + length, it->size - (size_t)length, format, arguments);
        va_end(arguments);
    }
    return 0;
}

/* Show a piece of a file in a message. */
static const char *shown(piece_t piece, char shown[LONGEST_SHOWN + 1])
{
    size_t length = 0;
    for (; length < piece.length && length < LONGEST_SHOWN; ++length) {
        const char c = piece.begin[length];
        shown[length] = c >= 32 && c < 127 ? c : '?';
    }
    shown[length] = '\0';
    return length > 0 ? shown : "nothing";
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
static int next_line(reader_t *it, piece_t *line)
{
    size_t length = 0;
    int c = getc(it->stream);
    if (c == EOF) {
        return 0;
    }
    it->line += 1;
    for (; c != EOF && c != '\n' && length < sizeof it->text; c = getc(it->stream)) {
        it->text[length++] = (char)c;
    }
    line->begin = it->text;
    line->length = length > 0 && it->text[length - 1] == '\r' ? length - 1 : length;
    if (length == sizeof it->text || line->length > LONGEST_LINE) {
        wrong(it, it->line, "expected at most %d characters, got more", (int)LONGEST_LINE);
        return -1;
    }
    return 1;
}

static piece_t stripped(piece_t piece)
{
    while (piece.length > 0 && (piece.begin[0] == ' ' || piece.begin[0] == '\t')) {
        piece.begin += 1;
        piece.length -= 1;
    }
    while (piece.length > 0 && (piece.begin[piece.length - 1] == ' ' || piece.begin[piece.length - 1] == '\t')) {
        piece.length -= 1;
    }
    return piece;
}

/* Cut the cell before the next comma off a line; returns 0 where there is none left, which its begin is NULL for. */
static int next_cell(piece_t *line, piece_t *cell)
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

static int is_named(piece_t cell, const char *name)
{
    if (cell.length >= 2 && cell.begin[0] == '"' && cell.begin[cell.length - 1] == '"') {
        cell.begin += 1;
        cell.length -= 2;
    }
    return cell.length == strlen(name) && memcmp(cell.begin, name, cell.length) == 0;
}

static int read_header(reader_t *it)
{
    char got[LONGEST_SHOWN + 1];
    int times = 0, accelerations = 0, displacements = 0;
    piece_t line = {it->text, 0}, header, cell;
    if (next_line(it, &line) < 0) {
        return 0;
    }
    it->line = 1;
    if (line.length >= 3 && memcmp(line.begin, "\xef\xbb\xbf", 3) == 0) {
        line.begin += 3;
        line.length -= 3;
    }
    header = line;
    for (it->columns = 0; next_cell(&line, &cell); ++it->columns) {
        const int is_time = is_named(cell, "time");
        const int is_acceleration = is_named(cell, "acceleration"), is_displacement = is_named(cell, "displacement");
        times += is_time;
        accelerations += is_acceleration;
        displacements += is_displacement;
        it->time_column = is_time ? it->columns : it->time_column;
        it->value_column = is_acceleration || is_displacement ? it->columns : it->value_column;
    }
    it->of_acceleration = accelerations > 0;
    return (times == 1 && accelerations + displacements == 1) ||
           wrong(it, 1, "expected the columns time and one of acceleration, displacement, got %s", shown(header, got));
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

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

/* The number in a cell, or NAN. The library's function wants the decimal point of the host's locale. */
static double number_in(piece_t cell)
{
    char text[LONGEST_NUMBER + 1], localised[LONGEST_NUMBER + 16], half[16];
    if (cell.length > LONGEST_NUMBER) {
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

static int read_number(const reader_t *it, piece_t cell, const char *name, double *value)
{
    char got[LONGEST_SHOWN + 1];
    *value = number_in(cell);
    return fabs(*value) <= largest || wrong(it, it->line, "expected a number of up to %g either way as %s, got %s",
                                            largest, name, shown(cell, got));
}

static int read_row(const reader_t *it, piece_t line, double *time, double *value)
{
    piece_t cell, time_cell = {NULL, 0}, value_cell = {NULL, 0};
    size_t column = 0;
    for (; next_cell(&line, &cell); ++column) {
        time_cell = column == it->time_column ? cell : time_cell;
        value_cell = column == it->value_column ? cell : value_cell;
    }
    if (column != it->columns) {
        return wrong(it, it->line, "expected %lu columns, got %lu", (unsigned long)it->columns, (unsigned long)column);
    }
    return read_number(it, time_cell, "time", time) &&
           read_number(it, value_cell, it->of_acceleration ? "acceleration" : "displacement", value);
}

/* Make room for one more sample. */
static int grow(const reader_t *it, recording_samples *samples, size_t *room)
{
    if (samples->count < *room) {
        return 1;
    }
    if (samples->count == MOST_ROWS) {
        return wrong(it, it->line, "expected at most %d rows, got more", (int)MOST_ROWS);
    }
    const size_t wanted = *room < 1024 ? 1024 : *room < MOST_ROWS / 2 ? 2 * *room : MOST_ROWS;
    double *times = realloc(samples->times, wanted * sizeof *times);
    samples->times = times != NULL ? times : samples->times;
    double *values = realloc(samples->values, wanted * sizeof *values);
    samples->values = values != NULL ? values : samples->values;
    *room = wanted;
    return (times != NULL && values != NULL) ||
           wrong(it, it->line, "expected memory for %lu rows, got none", (unsigned long)wanted);
}

static int read_rows(reader_t *it, recording_samples *samples)
{
    piece_t line;
    long empty = 0;
    size_t room = 0;
    int found;
    while ((found = next_line(it, &line)) > 0) {
        double time, value;
        if (stripped(line).length == 0) {
            empty = empty != 0 ? empty : it->line;
            continue;
        }
        if (empty != 0) {
            return wrong(it, empty, "expected no empty line but at the end, got one");
        }
        if (!read_row(it, line, &time, &value)) {
            return 0;
        }
        if (samples->count > 0 && !(time > samples->times[samples->count - 1])) {
            return wrong(it, it->line, "expected a time above %.10g s, got %.10g s", samples->times[samples->count - 1],
                         time);
        }
        if (!grow(it, samples, &room)) {
            return 0;
        }
        samples->times[samples->count] = time;
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
static int check(const reader_t *it, const recording_samples *samples)
{
    if (samples->count < RECORDING_FEWEST_ROWS) {
        return wrong(it, it->line, "expected at least %d rows, got %lu", (int)RECORDING_FEWEST_ROWS,
                     (unsigned long)samples->count);
    }
    const size_t count = samples->count - 1;
    double *steps = malloc(count * sizeof *steps);
    if (steps == NULL) {
        return wrong(it, it->line, "expected memory for %lu rows, got none", (unsigned long)count);
    }
    for (size_t i = 0; i < count; ++i) {
        steps[i] = samples->times[i + 1] - samples->times[i];
    }
    qsort(steps, count, sizeof *steps, ascending);
    const double median = steps[(count - 1) / 2];
    free(steps);
    for (size_t i = 0; i < count; ++i) {
        const double step = samples->times[i + 1] - samples->times[i];
        if (step < shortest_step) {
            return wrong(it, (long)i + 3, "expected a step of at least %g s, got %.10g s", shortest_step, step);
        }
        if (step > widest_gap * median) {
            return wrong(it, (long)i + 3, "expected a step of at most %g times the median of %.10g s, got %.10g s",
                         widest_gap, median, step);
        }
    }
    return 1;
}

const char *recording_read(const char *path, recording_samples *samples, char *message, size_t size)
{
    static const recording_samples none;
    reader_t it = {path, open_file(path), 0, {0}, 0, 0, 0, 0, message, size};
    int fine = 0, readable = 0;
    *samples = none;
    if (it.stream != NULL) {
        fine = read_header(&it) && read_rows(&it, samples) && check(&it, samples);
        readable = !ferror(it.stream);
        fclose(it.stream);
    }
    if (!readable) {
        snprintf(message, size, "%s: expected a file that can be read, got none", path);
    }
    if (!fine || !readable) {
        recording_free(samples);
        return message;
    }
    samples->of_acceleration = it.of_acceleration;
    const double first = samples->times[0];
    for (size_t i = 0; i < samples->count; ++i) {
        samples->times[i] = samples->times[i] - first;
    }
    return NULL;
}

void recording_free(recording_samples *samples)
{
    static const recording_samples none;
    free(samples->times);
    free(samples->values);
    *samples = none;
}
