// SPDX-License-Identifier: Apache-2.0
#include "cde/io/rays_csv.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "io/array_table.hpp"
#include "io/ray_table.hpp"
#include "support/file_io.hpp"
#include "support/table_text.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

constexpr std::size_t kFields = 8, kNeeded = 6;
constexpr std::string_view kExpected = "ox,oy,oz,dx,dy,dz[,tmin[,tmax]]";

/// The place in a message: "rays.csv:12:7" or "--ray:7".
struct CsvPlace {
  std::string_view name;
  std::size_t line;  // 0: the text is a single line without a number

  [[noreturn]] void fail(ErrorCode code, std::size_t column, const std::string& why) const {
    if (line == 0) throw Error(code, fmt::format("{}:{}: {}", name, column, why));
    throw Error(code, fmt::format("{}:{}:{}: {}", name, line, column, why));
  }
  void need(const std::optional<text::Problem>& problem) const {
    if (problem) fail(ErrorCode::kFile, problem->column, problem->why);
  }
};

float parse_number(const text::Field& at, text::Separator separator, std::size_t field,
                   const CsvPlace& place) {
  const auto name = [field] { return ray_table().names[field]; };
  if (at.text.empty()) place.fail(ErrorCode::kFile, at.column, name() + " is empty");
  float value = 0;
  const text::Number result = text::parse_float(at.text, value);
  if (result != text::Number::kOk)
    place.fail(
        ErrorCode::kFile, at.column,
        fmt::format("{}: {}", name(),
                    result == text::Number::kOverflow ? in_quotes(at.text) + " overflows a float"
                                                      : text::not_a_number(at, separator)));
  if (std::isnan(value)) place.fail(ErrorCode::kBadInput, at.column, name() + " is nan");
  if (field < kNeeded && std::isinf(value))
    place.fail(ErrorCode::kBadInput, at.column, name() + " is infinite");
  return value;
}

/// The row that the table read last.
Ray ray_of(const text::TableText& table, std::string_view line, const CsvPlace& place) {
  Ray ray;
  std::array<float, kFields> values = {0, 0, 0, 0, 0, 0, ray.tmin, ray.tmax};
  const auto fields = table.fields();
  const std::size_t columns = table.columns();
  std::size_t direction = 1;  // the column of dx in the text
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i == columns)
      place.fail(ErrorCode::kFile, fields[i].column,
                 table.named() ? fmt::format("too many fields: the header names {}", columns)
                               : fmt::format("too many fields: a ray has 6 to 8 ({})", kExpected));
    const std::size_t field = table.name_of(i);
    values[field] = parse_number(fields[i], table.separator(), field, place);
    if (field == 3) direction = fields[i].column;
  }
  for (std::size_t i = fields.size(); i < columns; ++i) {
    const std::size_t field = table.name_of(i);
    if (field >= kNeeded) continue;  // tmin and tmax are optional at the end of a line
    place.fail(
        ErrorCode::kFile, line.size() + 1,
        table.named()
            ? fmt::format("too few fields: {} of the {} in the header; {} is missing",
                          fields.size(), columns, ray_table().names[field])
            : fmt::format("too few fields: {} of at least 6 ({})", fields.size(), kExpected));
  }
  ray.o = {values[0], values[1], values[2]};
  ray.d = {values[3], values[4], values[5]};
  ray.tmin = values[6];
  ray.tmax = values[7];
  if (const auto why = defect(ray)) place.fail(ErrorCode::kBadInput, direction, *why);
  return ray;
}

}  // namespace

std::vector<Ray> read_rays_csv(const std::filesystem::path& path) {
  return rays_in_text(file_io::read_regular(path), printable_name(path.string()));
}

std::vector<Ray> read_rays_csv(std::istream& in, std::string_view name) {
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) throw Error(ErrorCode::kFile, fmt::format("{}: cannot be read", name));
  return rays_in_text(bytes, name);
}

std::vector<Ray> rays_in_text(std::string_view bytes, std::string_view name) {
  text::require_utf8(bytes, name);
  if (io::is_array(bytes))
    throw Error(ErrorCode::kFile, fmt::format("{}: is a NumPy array; expected rays as text", name));
  std::vector<Ray> rays;
  text::Lines lines(text::without_mark(bytes));
  text::TableText table(ray_table());
  table.look_at(bytes);
  auto kind = text::TableText::Kind::kNothing;
  while (const auto line = lines.next()) {
    const CsvPlace place{name, lines.number()};
    place.need(table.read(*line, kind));
    if (kind == text::TableText::Kind::kRow) rays.push_back(ray_of(table, *line, place));
  }
  return rays;
}

Ray parse_ray(std::string_view text, std::string_view name) {
  text::TableText table(ray_table());
  const CsvPlace place{name, 0};
  place.need(table.read_row(text));
  return ray_of(table, text, place);
}

}  // namespace cde
