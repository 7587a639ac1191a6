/* SPDX-License-Identifier: MIT
 *
 * Text files of the intercomparisons of radiation codes.
 *
 * - A cloud of libRadtran's MYSTIC (wc_file 3D in its manual), which IPRT and others pass on:
 *       Nx Ny Nz flag
 *       dx dy z(1) ... z(Nz + 1)
 *       ix iy iz ...
 *   with lengths in km and the columns "ext g ssa" (flag 1; extinction in 1/km), "ext reff" (flag
 *   2; um) or "lwc reff" (flag 3; g/m3). z are ends of cells; comments begin with #.
 * - A cloud of I3RC's community model and of SHDOM (tools ParticleFileToDomain and propgen): a line
 *   that begins with the number of its parameters, Nx Ny Nz, dx dy, heights, temperatures, and rows
 *   "ix iy iz lwc" (1 parameter) or "ix iy iz lwc reff" (2), in the same units. Nz + 1 heights are
 *   ends of cells (I3RC), Nz are levels of nodes, the first node at x = y = 0 (SHDOM).
 * - A table of numbers and nothing else, such as those of I3RC's phase I: x fastest, then y, then
 *   layers from the top down. Its size is a key of the scene, since no file has it.
 *
 * Indices count from 1 on. Voxels without a row are 0.
 */
#include "scenes/file_units.h"
#include "scenes/text_numbers.h"
#include "scenes/volume_file.h"
#include "scenes/volume_format.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_SIDE_MAX = 65535, COLUMNS_MAX = 3 };

/* Lengths [km] and values of a file; above these they are in another unit, or damaged. */
static const double length_max_km = 1e4, value_max = 1e6;

/* The columns after the indices: the first is the value. */
struct layout {
    const char *names[COLUMNS_MAX]; /* fewer: NULL */
    const char *unit;
    int radius; /* column of the radius; 0: none */
};

static const struct layout mystic_layouts[] = {{{"ext", "g", "ssa"}, "1/km", 0},
                                               {{"ext", "reff", NULL}, "1/km", 1},
                                               {{"lwc", "reff", NULL}, "g/m3", 1}};
static const struct layout i3rc_layouts[] = {{{"lwc", NULL, NULL}, "g/m3", 0},
                                             {{"lwc", "reff", NULL}, "g/m3", 1}};
static const struct layout table_layout = {{"value", NULL, NULL}, "1", 0};

struct text {
    const struct neph_volume_request *request;
    struct neph_text_numbers numbers;
    const struct layout *layout;
    int size[3]; /* of the file */
    double spacing_km[2];
    double *heights_km; /* owned; size[2] + 1, of which height_count are in the file */
    int height_count;
    struct neph_volume_box box;
    int read[3];                   /* size of the box */
    float *values, *radii;         /* owned, of the box; NaN: no row yet. radii: NULL without */
    double constants[COLUMNS_MAX]; /* of columns that a scene has as keys; NaN: no row yet */
    char note[NEPH_GRID_NOTE_SIZE];
};

/* ---- headers --------------------------------------------------------------------------------- */

static enum neph_status read_sides(struct text *text, int first, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int axis = first; axis < 3 && !status; axis++)
        status = neph_text_next_whole(&text->numbers, "a number of voxels", 1, FILE_SIDE_MAX,
                                      &text->size[axis], diag);
    return status;
}

static enum neph_status read_spacing(struct text *text, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int axis = 0; axis < 2 && !status; axis++)
        status = neph_text_next_number(&text->numbers, "a distance in km", 1e-7, length_max_km,
                                       &text->spacing_km[axis], diag);
    return status;
}

static enum neph_status refuse_heights(const struct text *text, int count, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "%d heights for %d layers", count, text->size[2]);
    neph_hint(diag,
              "one line has the %d ends of its cells in km; a file for SHDOM may have %d levels",
              text->size[2] + 1, text->size[2]);
    return NEPH_ERR_INPUT;
}

/* Heights up to the end of a line. */
static enum neph_status read_heights(struct text *text, struct neph_diag *diag)
{
    struct neph_text_numbers *numbers = &text->numbers;
    int count = 0;
    text->heights_km = calloc((size_t)text->size[2] + 1, sizeof(*text->heights_km));
    if (!text->heights_km)
        return neph_fail_memory(diag);
    do {
        double height_km = 0.0;
        const enum neph_status status = neph_text_next_number(
            numbers, "a height in km", -length_max_km, length_max_km, &height_km, diag);
        if (status)
            return status;
        if (count > 0 && count <= text->size[2] && !(height_km > text->heights_km[count - 1]))
            return neph_fail(diag, NEPH_ERR_INPUT, "heights do not ascend: %g km after %g km",
                             height_km, text->heights_km[count - 1]);
        if (count <= text->size[2])
            text->heights_km[count] = height_km;
        count++;
    } while (!neph_text_is_line_read(numbers));
    text->height_count = count;
    return NEPH_OK;
}

/* One for each height, in a line. */
static enum neph_status skip_temperatures(struct text *text, struct neph_diag *diag)
{
    double kelvin = 0.0;
    int count = 0;
    do {
        const enum neph_status status = neph_text_next_number(&text->numbers, "a temperature in K",
                                                              0.0, 1e4, &kelvin, diag);
        if (status)
            return status;
        count++;
    } while (!neph_text_is_line_read(&text->numbers));
    return count == text->height_count
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_INPUT, "%d temperatures for %d heights", count,
                           text->height_count);
}

/* After the number of voxels along x. */
static enum neph_status read_mystic_header(struct text *text, struct neph_diag *diag)
{
    int flag = 0;
    enum neph_status status = read_sides(text, 1, diag);
    if (!status)
        status = neph_text_next_whole(&text->numbers, "a flag", 1, 3, &flag, diag);
    if (!status && !neph_text_is_line_read(&text->numbers))
        status = neph_fail(diag, NEPH_ERR_INPUT, "more than \"Nx Ny Nz flag\" in its first line");
    if (!status)
        status = read_spacing(text, diag);
    if (!status)
        status = read_heights(text, diag);
    if (!status && text->height_count != text->size[2] + 1)
        status = refuse_heights(text, text->height_count, diag);
    if (!status)
        text->layout = &mystic_layouts[flag - 1];
    return status;
}

static enum neph_status read_i3rc_header(struct text *text, int parameters, struct neph_diag *diag)
{
    struct neph_text_numbers *numbers = &text->numbers;
    if (parameters < 1 || parameters > 2) {
        neph_fail(diag, NEPH_ERR_INPUT, "a cloud of %d parameters, not 1 or 2", parameters);
        neph_hint(diag, "write a file of several kinds of particles as one file for each");
        return NEPH_ERR_INPUT;
    }
    neph_text_skip_line(numbers);
    enum neph_status status = read_sides(text, 0, diag);
    if (!status)
        status = read_spacing(text, diag);
    if (!status)
        status = read_heights(text, diag);
    if (!status && text->height_count != text->size[2] && text->height_count != text->size[2] + 1)
        status = refuse_heights(text, text->height_count, diag);
    if (!status)
        status = skip_temperatures(text, diag);
    if (!status && text->height_count == 1)
        status = neph_fail(diag, NEPH_ERR_INPUT, "one level, which has no thickness");
    if (!status)
        text->layout = &i3rc_layouts[parameters - 1];
    return status;
}

/* The first line of MYSTIC has numbers of voxels, the other a number and words or nothing. */
static enum neph_status read_header(struct text *text, struct neph_diag *diag)
{
    struct neph_text_numbers *numbers = &text->numbers;
    if (text->request->table_size) {
        memcpy(text->size, text->request->table_size, sizeof(text->size));
        text->layout = &table_layout;
        return NEPH_OK;
    }
    numbers->has_comments = true;
    int first = 0;
    enum neph_status status = neph_text_next_whole(numbers, "a number of voxels or parameters", 1,
                                                   FILE_SIDE_MAX, &first, diag);
    if (status) {
        neph_hint(diag, "it is not a cloud of MYSTIC or I3RC; table_size reads a table of numbers");
        return status;
    }
    const int byte = neph_text_is_line_read(numbers) ? '\n' : fgetc(numbers->file);
    if (byte != '\n')
        ungetc(byte, numbers->file);
    text->size[0] = first;
    return strchr("0123456789", byte) ? read_mystic_header(text, diag)
                                      : read_i3rc_header(text, first, diag);
}

/* ---- rows ------------------------------------------------------------------------------------ */

static enum neph_status allocate(struct text *text, struct neph_diag *diag)
{
    const struct neph_volume_request *request = text->request;
    enum neph_status status = neph_volume_find_box(request, text->size, &text->box, diag);
    for (int axis = 0; axis < 3; axis++)
        text->read[axis] = text->box.last[axis] - text->box.first[axis] + 1;
    if (!status)
        status = neph_volume_check_size(request, text->read, diag);
    if (status)
        return status;
    const size_t count = (size_t)text->read[0] * (size_t)text->read[1] * (size_t)text->read[2];
    text->values = malloc(count * sizeof(*text->values));
    text->radii = request->radius_name ? calloc(count, sizeof(*text->radii)) : NULL;
    if (!text->values || (request->radius_name && !text->radii))
        return neph_fail_memory(diag);
    for (size_t i = 0; i < count; i++)
        text->values[i] = NAN;
    for (int column = 0; column < COLUMNS_MAX; column++)
        text->constants[column] = NAN;
    return NEPH_OK;
}

/* The place of a voxel in the box; SIZE_MAX: outside. */
static size_t find_voxel(const struct text *text, const int at[3])
{
    size_t place = 0;
    for (int axis = 2; axis >= 0; axis--) {
        const int first = text->box.first[axis];
        if (at[axis] < first || at[axis] > text->box.last[axis])
            return SIZE_MAX;
        place = place * (size_t)text->read[axis] + (size_t)(at[axis] - first);
    }
    return place;
}

/* Columns that the scene has as keys must have one value, which the note says. */
static enum neph_status check_constant(struct text *text, int column, double value,
                                       struct neph_diag *diag)
{
    double *constant = &text->constants[column];
    if (isnan(*constant))
        *constant = value;
    if (value == *constant)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "%s changes from %g to %g", text->layout->names[column],
              *constant, value);
    neph_hint(diag, "a medium has one: write a file for each value of it, as media of their own");
    return NEPH_ERR_INPUT;
}

static enum neph_status read_columns(struct text *text, size_t voxel, struct neph_diag *diag)
{
    const struct layout *layout = text->layout;
    enum neph_status status = NEPH_OK;
    for (int column = 0; column < COLUMNS_MAX && layout->names[column] && !status; column++) {
        double value = 0.0;
        status = neph_text_next_number(&text->numbers, layout->names[column],
                                       column == 1 && !layout->radius ? -1.0 : 0.0, value_max,
                                       &value, diag);
        if (!status && column > 0 && column != layout->radius)
            status = check_constant(text, column, value, diag);
        if (status || voxel == SIZE_MAX)
            continue;
        if (column == 0)
            text->values[voxel] = (float)value;
        else if (column == layout->radius && text->radii)
            text->radii[voxel] = (float)value;
    }
    return status;
}

/* A row, whose first word was read. */
static enum neph_status read_row(struct text *text, struct neph_diag *diag)
{
    struct neph_text_numbers *numbers = &text->numbers;
    int at[3];
    for (int axis = 0; axis < 3; axis++) {
        double index = 0.0;
        enum neph_status status = axis > 0 ? neph_text_next_word(numbers, diag) : NEPH_OK;
        if (!status)
            status = neph_text_to_number(numbers, "an index of a voxel", 1.0, text->size[axis],
                                         &index, diag);
        if (status)
            return status;
        if (index != floor(index))
            return neph_fail(diag, NEPH_ERR_INPUT, "%g is not an index of a voxel", index);
        at[axis] = (int)index - 1;
    }
    const size_t voxel = find_voxel(text, at);
    if (voxel != SIZE_MAX && !isnan(text->values[voxel]))
        return neph_fail(diag, NEPH_ERR_INPUT, "voxel (%d, %d, %d) has a second row", at[0] + 1,
                         at[1] + 1, at[2] + 1);
    return read_columns(text, voxel, diag);
}

static enum neph_status read_rows(struct text *text, struct neph_diag *diag)
{
    struct neph_text_numbers *numbers = &text->numbers;
    enum neph_status status = neph_text_next_word(numbers, diag);
    if (!status && !numbers->word[0])
        return neph_fail(diag, NEPH_ERR_INPUT, "no voxels after its header");
    while (!status && numbers->word[0]) {
        status = read_row(text, diag);
        if (!status && !neph_text_is_line_read(numbers))
            status = neph_fail(diag, NEPH_ERR_INPUT, "more numbers than a row has");
        if (!status)
            status = neph_text_next_word(numbers, diag);
    }
    return status;
}

/* Layers from the top down. */
static enum neph_status read_table(struct text *text, struct neph_diag *diag)
{
    const int *size = text->size;
    enum neph_status status = NEPH_OK;
    for (int k = size[2] - 1; k >= 0; k--)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0] && !status; i++)
                status = read_columns(text, find_voxel(text, (const int[3]){i, j, k}), diag);
    if (!status)
        status = neph_text_next_word(&text->numbers, diag);
    return !status && text->numbers.word[0]
               ? neph_fail(diag, NEPH_ERR_INPUT, "more than %d x %d x %d numbers, its table_size",
                           size[0], size[1], size[2])
               : status;
}

static enum neph_status add_line(const struct text *text, enum neph_status status,
                                 struct neph_diag *diag)
{
    if (status == NEPH_ERR_INPUT)
        neph_prefix(diag, "line %d: ", text->numbers.line);
    return status;
}

static enum neph_status read_text(struct text *text, struct neph_diag *diag)
{
    enum neph_status status = add_line(text, read_header(text, diag), diag);
    if (!status)
        status = allocate(text, diag);
    if (status)
        return status;
    const bool is_table = text->request->table_size;
    return add_line(text, is_table ? read_table(text, diag) : read_rows(text, diag), diag);
}

/* ---- the grid -------------------------------------------------------------------------------- */

static enum neph_status check_names(const struct text *text, struct neph_diag *diag)
{
    const struct neph_volume_request *request = text->request;
    const struct layout *layout = text->layout;
    const char *name = request->grid_name, *radius = request->radius_name;
    if (name && strcmp(name, layout->names[0]) != 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "it has no '%s'; its values are '%s'", name,
                         layout->names[0]);
    if (radius && (!layout->radius || strcmp(radius, layout->names[layout->radius]) != 0))
        return neph_fail(diag, NEPH_ERR_INPUT, "it has no '%s'; %s", radius,
                         layout->radius ? "its radii are 'reff'" : "its rows have no radius");
    return NEPH_OK;
}

static enum neph_status convert_values(struct text *text, struct neph_diag *diag)
{
    const size_t count = (size_t)text->read[0] * (size_t)text->read[1] * (size_t)text->read[2];
    double factor = 1.0;
    enum neph_status status = text->request->table_size
                                  ? NEPH_OK
                                  : neph_volume_find_unit(text->request, text->layout->names[0],
                                                          text->layout->unit, &factor, diag);
    for (size_t i = 0; i < count && !status; i++)
        text->values[i] = isnan(text->values[i]) ? 0.0F : (float)(factor * (double)text->values[i]);
    if (!status && text->radii)
        status = neph_droplet_voxels_convert(&text->request->droplets, text->read, text->values,
                                             text->radii, text->note, diag);
    return status;
}

/* The scene's keys are used in place of these columns. */
static void note_constants(struct text *text)
{
    for (int column = 1; column < COLUMNS_MAX; column++)
        if (!isnan(text->constants[column])) {
            const size_t used = strlen(text->note);
            snprintf(text->note + used, sizeof(text->note) - used, "%s%s is %g in the file",
                     used ? "; " : "", text->layout->names[column], text->constants[column]);
        }
}

static enum neph_status place(struct text *text, struct neph_grid **grid, struct neph_diag *diag)
{
    static const double m_per_km = 1e3;
    const bool is_table = text->request->table_size;
    const bool has_cells = is_table || text->height_count > text->size[2];
    double first[3] = {0.0}, spacing[3] = {1.0, 1.0, 1.0};
    enum neph_status status = NEPH_OK;
    for (int axis = 0; axis < 2 && !is_table; axis++) {
        spacing[axis] = m_per_km * text->spacing_km[axis];
        first[axis] = spacing[axis] * (text->box.first[axis] + (has_cells ? 0.5 : 0.0));
    }
    if (!is_table) {
        const int low = text->box.first[2], count = text->read[2];
        struct neph_even_levels even;
        for (int i = 0; i < text->height_count; i++)
            text->heights_km[i] *= m_per_km;
        if (count == 1 && !has_cells)
            return neph_fail(diag, NEPH_ERR_INPUT, "one level, which has no thickness");
        const struct neph_volume_levels levels = {
            2, {text->heights_km + low, count, has_cells}, "z"};
        status = neph_volume_make_even(text->request, &levels, text->read, &text->values, &even,
                                       text->note, diag);
        first[2] = even.first;
        spacing[2] = even.spacing;
    }
    note_constants(text);
    if (!status)
        status = neph_volume_make_grid(text->request, text->read, first, spacing, text->values,
                                       text->note, grid, diag);
    if (!status)
        (*grid)->is_constant = has_cells;
    return status;
}

enum neph_status neph_volume_read_text(const struct neph_volume_request *request,
                                       const struct neph_volume_source *source,
                                       struct neph_grid **grid, struct neph_diag *diag)
{
    struct text text = {.request = request, .numbers = {.file = source->file}};
    enum neph_status status = read_text(&text, diag);
    if (!status)
        status = check_names(&text, diag);
    if (!status)
        status = convert_values(&text, diag);
    if (!status)
        status = place(&text, grid, diag);
    free(text.heights_km);
    free(text.values);
    free(text.radii);
    return status;
}
