/* SPDX-License-Identifier: MIT
 *
 * The whole of a PLY file, as its header declares it ("PLY - Polygon File Format", G. Turk 1994):
 * no element is cut off, vertices are finite, and faces name vertices that exist.
 */
#include "scenes/mesh_check.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

namespace
{

enum class number_kind { integer, natural, real };

struct number_type {
    const char *name, *new_name;
    size_t bytes;
    number_kind kind;
};

constexpr number_type types[] = {
    {"char", "int8", 1, number_kind::integer},   {"uchar", "uint8", 1, number_kind::natural},
    {"short", "int16", 2, number_kind::integer}, {"ushort", "uint16", 2, number_kind::natural},
    {"int", "int32", 4, number_kind::integer},   {"uint", "uint32", 4, number_kind::natural},
    {"float", "float32", 4, number_kind::real},  {"double", "float64", 8, number_kind::real},
};

struct property {
    std::string name;
    const number_type *count; /* of a list; nullptr: one number */
    const number_type *value;
};

struct element {
    std::string name;
    int64_t count;
    std::vector<property> properties;
};

class ply_file
{
  public:
    ply_file(const char *path, const mesh_limits &of_neph)
        : file(path, std::ios::binary), limits(of_neph)
    {
    }

    int64_t check()
    {
        read_header();
        for (const element &each : elements)
            for (int64_t i = 0; i < each.count && !each.properties.empty(); i++)
                check_item(each, i);
        return std::max(find_count("face"), int64_t{0});
    }

  private:
    /* ---- the header -------------------------------------------------------------------------- */

    std::string header_line()
    {
        if (!std::getline(file, text) || text.size() > 4096)
            throw bad_file("damaged: its header has no end_header");
        line++;
        return text.substr(0, text.find('\r'));
    }
    [[noreturn]] void refuse_header() const
    {
        throw bad_file(words("line %lld of its header, '%.60s', is no PLY",
                             static_cast<long long>(line), text.c_str()));
    }
    const number_type *find_type(const std::string &name) const
    {
        for (const number_type &each : types)
            if (name == each.name || name == each.new_name)
                return &each;
        refuse_header();
    }

    void read_header()
    {
        if (header_line() != "ply")
            throw bad_file("it is not a PLY file: its first line is not 'ply'");
        for (std::string words_of_line = header_line(); words_of_line != "end_header";
             words_of_line = header_line()) {
            std::istringstream in(words_of_line);
            std::string keyword;
            in >> keyword;
            if (keyword == "format")
                read_format(in);
            else if (keyword == "element")
                read_element(in);
            else if (keyword == "property")
                read_property(in);
            else if (keyword != "comment" && keyword != "obj_info")
                refuse_header();
        }
        if (format.empty())
            throw bad_file("damaged: its header has no format");
        if (find_count("vertex") > limits.vertices_max || find_count("face") > limits.triangles_max)
            refuse_triangles(limits);
    }
    void read_format(std::istringstream &in)
    {
        in >> format;
        is_text = format == "ascii";
        is_reversed = format == "binary_big_endian";
        if (!is_text && !is_reversed && format != "binary_little_endian")
            refuse_header();
    }
    void read_element(std::istringstream &in)
    {
        element made = {"", -1, {}};
        in >> made.name >> made.count;
        if (in.fail() || made.count < 0)
            refuse_header();
        elements.push_back(made);
    }
    void read_property(std::istringstream &in)
    {
        property made = {"", nullptr, nullptr};
        std::string type;
        in >> type;
        if (type == "list") {
            in >> type;
            made.count = find_type(type);
            in >> type;
        }
        made.value = find_type(type);
        in >> made.name;
        if (in.fail() || elements.empty() || (made.count && made.count->kind == number_kind::real))
            refuse_header();
        elements.back().properties.push_back(made);
    }
    int64_t find_count(const char *name) const
    {
        for (const element &each : elements)
            if (each.name == name)
                return each.count;
        return -1;
    }

    /* ---- the elements ------------------------------------------------------------------------ */

    [[noreturn]] void refuse(const element &of, int64_t index, const char *what) const
    {
        throw bad_file(
            words("%s%s %lld of %lld %s",
                  is_text ? words("line %lld: ", static_cast<long long>(line)).c_str() : "",
                  of.name.c_str(), static_cast<long long>(index), static_cast<long long>(of.count),
                  what));
    }

    /* In text an item is a line. */
    void check_item(const element &of, int64_t index)
    {
        if (is_text) {
            if (!std::getline(file, text))
                refuse(of, index, "is missing: the file is truncated");
            line++;
            at = text.c_str();
        }
        for (const property &each : of.properties) {
            const double count = each.count ? next(of, index, *each.count) : 1.0;
            const bool is_face = of.name == "face" && is_corner(each);
            if (!(count >= (is_face ? 3.0 : 0.0) && count <= 1e9))
                refuse(of, index, words("has %g %s", count, each.name.c_str()).c_str());
            for (int64_t i = 0; i < static_cast<int64_t>(count); i++)
                check_value(of, index, each, next(of, index, *each.value));
        }
        if (is_text && at[strspn(at, " \t\r")] != '\0')
            refuse(of, index, "has more numbers than the header declares");
    }
    static bool is_corner(const property &each)
    {
        return each.name == "vertex_indices" || each.name == "vertex_index";
    }
    void check_value(const element &of, int64_t index, const property &each, double value) const
    {
        const bool is_coordinate = each.name == "x" || each.name == "y" || each.name == "z";
        if (of.name == "vertex" && is_coordinate &&
            !(std::fabs(value) <= static_cast<double>(FLT_MAX)))
            refuse(of, index, words("has %s = %g", each.name.c_str(), value).c_str());
        const int64_t vertices = find_count("vertex");
        const bool is_vertex = value >= 0.0 && value < static_cast<double>(vertices);
        if (of.name == "face" && is_corner(each) && !(is_vertex && value == std::floor(value)))
            refuse(of, index,
                   words("names vertex %g; there are 0 to %lld", value,
                         static_cast<long long>(vertices - 1))
                       .c_str());
    }

    double next(const element &of, int64_t index, const number_type &type)
    {
        if (is_text) {
            char *end = nullptr;
            const double value = strtod(at, &end);
            if (end == at || !strchr(" \t\r", *end))
                refuse(of, index, "has fewer numbers than the header declares");
            at = end;
            return value;
        }
        char bytes[8] = {};
        if (!file.read(bytes, static_cast<std::streamsize>(type.bytes)))
            refuse(of, index, "is missing: the file is truncated");
        if (is_reversed)
            std::reverse(bytes, bytes + type.bytes);
        return type.kind == number_kind::real ? real(bytes, type.bytes)
                                              : integer(bytes, type.bytes, type.kind);
    }
    static double real(const char *bytes, size_t size)
    {
        float narrow = 0.0f;
        double wide = 0.0;
        memcpy(size == sizeof(wide) ? static_cast<void *>(&wide) : &narrow, bytes, size);
        return size == sizeof(wide) ? wide : static_cast<double>(narrow);
    }
    /* Little endian. */
    static double integer(const char *bytes, size_t size, number_kind kind)
    {
        int64_t value = 0;
        memcpy(&value, bytes, size);
        const int64_t range = int64_t{1} << (8 * size);
        return static_cast<double>(
            kind == number_kind::integer && value >= range / 2 ? value - range : value);
    }

    std::ifstream file;
    const mesh_limits &limits;
    std::string format, text; /* the last line */
    std::vector<element> elements;
    const char *at = ""; /* in it */
    int64_t line = 0;
    bool is_text = false, is_reversed = false;
};

} // namespace

int64_t check_ply(const char *path, const mesh_limits &limits)
{
    return ply_file(path, limits).check();
}
