#include "rbvi/io/vtu.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/write_atomically.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace rbvi {

namespace {

constexpr Index most_ascii_nodes = 2000;

template <class Number> const char *vtk_type() {
  if constexpr (std::is_same_v<Number, double>) return "Float64";
  if constexpr (std::is_same_v<Number, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<Number, std::int64_t>) return "Int64";
  return "UInt8";
}

template <class Number> void append_number(std::string &text, Number value, char separator) {
  char digits[32];
  char *const end = digits + sizeof digits;
  if constexpr (sizeof(Number) == 1)
    text.append(digits, std::to_chars(digits, end, static_cast<int>(value)).ptr);
  else
    text.append(digits, std::to_chars(digits, end, value).ptr);
  text += separator;
}

template <class Number> std::string bytes_of(std::span<const Number> values) {
  return {reinterpret_cast<const char *>(values.data()), values.size_bytes()};
}

/// As RFC 4648 has it: three bytes are four characters, the last ones padded by '='.
void append_base64(std::string &text, const std::string &bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  text.reserve(text.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? digits[word >> (18 - 6 * k) & 63U] : '=';
  }
}

/// As an attribute of XML.
std::string escaped(const std::string &text) {
  std::string result;
  for (const char letter : text)
    if (const std::size_t at = std::string_view("&<>\"").find(letter); at != std::string::npos)
      result += std::array{"&amp;", "&lt;", "&gt;", "&quot;"}[at];
    else
      result += letter;
  return result;
}

class Writer {
public:
  explicit Writer(VtuFormat format) : format_(format) {}

  void line(const std::string &xml) { xml_ += xml + "\n"; }

  template <class Number>
  void array(const std::string &name, std::span<const Number> values, std::size_t components) {
    open(vtk_type<Number>(), name, "NumberOfComponents", components);
    if (format_ == VtuFormat::base64) {
      line(" format=\"binary\">");
      const std::uint64_t size = values.size_bytes();
      append_base64(xml_, bytes_of(std::span(&size, 1)) + bytes_of(values));
      line("\n</DataArray>");
      return;
    }
    line(" format=\"ascii\">");
    for (std::size_t i = 0; i < values.size(); ++i)
      append_number(xml_, values[i], (i + 1) % components == 0 ? '\n' : ' ');
    line("</DataArray>");
  }

  /// Field data, always in ASCII.
  void numbers(const Field &field) {
    open("Float64", field.name, "NumberOfTuples", static_cast<std::size_t>(field.values.size()));
    line(" format=\"ascii\">");
    for (const double value : field.values)
      append_number(xml_, value, '\n');
    line("</DataArray>");
  }
  /// Each text as the codes of its characters and a zero, as VTK has it.
  void texts(const std::string &name, const std::vector<std::string> &values) {
    open("String", name, "NumberOfTuples", values.size());
    line(" format=\"ascii\">");
    for (const std::string &value : values) {
      for (const char letter : value)
        append_number(xml_, static_cast<unsigned char>(letter), ' ');
      line("0");
    }
    line("</DataArray>");
  }

  const std::string &text() const { return xml_; }

private:
  void open(const std::string &type, const std::string &name, const std::string &counted,
            std::size_t count) {
    xml_ += "<DataArray type=\"" + type + "\" Name=\"" + escaped(name) + "\" " + counted + "=\"" +
            std::to_string(count) + "\"";
  }

  VtuFormat format_;
  std::string xml_;
};

std::uint8_t vtk_cell_type(int per_cell) {
  if (per_cell == 2) return 3;
  if (per_cell == 3) return 5;
  if (per_cell == 4) return 10;
  if (per_cell == 6) return 22;
  if (per_cell == 10) return 24;
  throw failure("no VTU cell type has " + std::to_string(per_cell) + " nodes");
}

void write_points(Writer &out, const Matrix &points) {
  std::vector<double> coordinates;
  coordinates.reserve(3 * static_cast<std::size_t>(points.rows()));
  for (Index i = 0; i < points.rows(); ++i)
    for (Index k = 0; k < 3; ++k)
      coordinates.push_back(k < points.cols() ? points(i, k) : 0);
  out.line("<Points>");
  out.array("points", std::span<const double>(coordinates), 3);
  out.line("</Points>");
}

void write_cells(Writer &out, const Grid &grid, std::size_t count) {
  const auto per_cell = static_cast<std::size_t>(grid.per_cell);
  const std::vector<std::int32_t> nodes(grid.cells.begin(), grid.cells.end());
  std::vector<std::int64_t> ends;
  for (std::size_t i = 1; i <= count; ++i)
    ends.push_back(static_cast<std::int64_t>(i * per_cell));
  const std::vector<std::uint8_t> types(count, vtk_cell_type(grid.per_cell));
  out.line("<Cells>");
  out.array("connectivity", std::span<const std::int32_t>(nodes), 1);
  out.array("offsets", std::span<const std::int64_t>(ends), 1);
  out.array("types", std::span<const std::uint8_t>(types), 1);
  out.line("</Cells>");
}

void write_fields(Writer &out, const std::string &where, const std::vector<Field> &fields,
                  Index count) {
  out.line("<" + where + ">");
  for (const Field &field : fields) {
    if (count == 0 || field.values.size() == 0 || field.values.size() % count != 0)
      throw failure("field " + field.name + " has " + std::to_string(field.values.size()) +
                    " values for " + std::to_string(count) + " nodes or cells");
    const std::span values(field.values.data(), static_cast<std::size_t>(field.values.size()));
    out.array(field.name, std::span<const double>(values),
              static_cast<std::size_t>(field.values.size() / count));
  }
  out.line("</" + where + ">");
}

void write_field_data(Writer &out, const Grid &grid) {
  std::vector<std::string> units{"points: " + grid.length};
  for (const auto *fields : {&grid.of_nodes, &grid.of_cells, &grid.of_all})
    for (const Field &field : *fields) {
      const std::string unit = fields == &grid.of_all ? field.unit
                               : field.unit == "m"    ? grid.length
                               : field.unit == "Pa"   ? grid.stress
                                                      : field.unit;
      const std::string line = field.name + ": " + (unit.empty() ? "-" : unit);
      if (std::find(units.begin(), units.end(), line) == units.end()) units.push_back(line);
    }
  out.line("<FieldData>");
  if (!grid.scene.empty()) out.texts("scene", {grid.scene});
  if (!grid.contacts.empty()) out.texts("contacts", grid.contacts);
  out.texts("units", units);
  for (const Field &field : grid.of_all)
    out.numbers(field);
  out.line("</FieldData>");
}

} // namespace

VtuFormat vtu_format(const Grid &grid) {
  return grid.points.rows() > most_ascii_nodes ? VtuFormat::base64 : VtuFormat::ascii;
}

void write_vtu(const std::filesystem::path &path, const Grid &grid, VtuFormat format) {
  const std::size_t cells = grid.cells.size() / static_cast<std::size_t>(grid.per_cell);
  const bool little = std::endian::native == std::endian::little;
  Writer out(format);
  out.line("<?xml version=\"1.0\"?>");
  out.line("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" +
           std::string(little ? "LittleEndian" : "BigEndian") + "\" header_type=\"UInt64\">");
  out.line("<UnstructuredGrid>");
  write_field_data(out, grid);
  out.line("<Piece NumberOfPoints=\"" + std::to_string(grid.points.rows()) + "\" NumberOfCells=\"" +
           std::to_string(cells) + "\">");
  write_points(out, grid.points);
  write_cells(out, grid, cells);
  write_fields(out, "PointData", grid.of_nodes, grid.points.rows());
  write_fields(out, "CellData", grid.of_cells, static_cast<Index>(cells));
  out.line("</Piece>");
  out.line("</UnstructuredGrid>");
  out.line("</VTKFile>");
  write_atomically(path, out.text());
}

} // namespace rbvi
