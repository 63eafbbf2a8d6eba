// SPDX-License-Identifier: Apache-2.0
#include "cde/io/rays_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/file_io.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

constexpr std::array<std::string_view, 8> kFields = {"ox", "oy", "oz",   "dx",
                                                     "dy", "dz", "tmin", "tmax"};
constexpr std::size_t kNeeded = 6;
constexpr std::string_view kExpected = "ox,oy,oz,dx,dy,dz[,tmin[,tmax]]";
constexpr std::string_view kExpectedNames =
    "expected ox, oy, oz, dx, dy, dz and, if wanted, tmin, tmax, in any order";

/// Which of kFields stands in each column of a line.
struct RayColumns {
  std::array<std::size_t, kFields.size()> field = {0, 1, 2, 3, 4, 5, 6, 7};
  std::size_t count = kFields.size();
  bool named = false;  // by a header
};

/// Where a message points: "rays.csv:12:7" or "--ray:7".
struct CsvPlace {
  std::string_view name;
  std::size_t line;  // 0: the text is a single line without a number

  [[noreturn]] void fail(ErrorCode code, std::size_t column, const std::string& why) const {
    if (line == 0) throw Error(code, fmt::format("{}:{}: {}", name, column, why));
    throw Error(code, fmt::format("{}:{}:{}: {}", name, line, column, why));
  }
};

/// The blank-trimmed text before the next comma, and its column from 1.
struct CsvField {
  std::string_view text;
  std::size_t column;
};

template <class Each>
void for_each_field(std::string_view line, Each each) {
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = line.find(',', start);
    const std::string_view raw =
        line.substr(start, comma == std::string_view::npos ? comma : comma - start);
    const std::string_view field = text::trim(raw);
    const std::size_t lead =
        field.empty() ? 0 : static_cast<std::size_t>(field.data() - raw.data());
    each(CsvField{field, start + lead + 1});
    if (comma == std::string_view::npos) return;
    start = comma + 1;
  }
}

float parse_number(const CsvField& at, std::size_t field, const CsvPlace& place) {
  const std::string_view name = kFields[field];
  if (at.text.empty()) place.fail(ErrorCode::kFile, at.column, fmt::format("{} is empty", name));
  float value = 0;
  const text::Number result = text::parse_float(at.text, value);
  if (result != text::Number::kOk) {
    place.fail(
        ErrorCode::kFile, at.column,
        fmt::format("{}: {} {}", name, in_quotes(at.text),
                    result == text::Number::kOverflow ? "overflows a float" : "is not a number"));
  }
  if (std::isnan(value))
    place.fail(ErrorCode::kBadInput, at.column, fmt::format("{} is nan", name));
  if (field < kNeeded && std::isinf(value))
    place.fail(ErrorCode::kBadInput, at.column, fmt::format("{} is infinite", name));
  return value;
}

Ray parse_line(std::string_view line, const CsvPlace& place, const RayColumns& columns) {
  Ray ray;
  std::array<float, kFields.size()> values = {0, 0, 0, 0, 0, 0, ray.tmin, ray.tmax};
  std::size_t count = 0;
  std::size_t direction = 1;  // where the text has dx
  for_each_field(line, [&](const CsvField& at) {
    if (count == columns.count) {
      place.fail(ErrorCode::kFile, at.column,
                 columns.named ? fmt::format("too many fields: the header names {}", columns.count)
                               : fmt::format("too many fields: a ray has 6 to 8 ({})", kExpected));
    }
    const std::size_t field = columns.field[count++];
    values[field] = parse_number(at, field, place);
    if (field == 3) direction = at.column;
  });
  for (std::size_t i = count; i < columns.count; ++i) {
    if (columns.field[i] >= kNeeded)
      continue;  // tmin and tmax may be left out at the end of a line
    place.fail(
        ErrorCode::kFile, line.size() + 1,
        columns.named
            ? fmt::format("too few fields: {} of the {} that the header names; {} is missing",
                          count, columns.count, kFields[columns.field[i]])
            : fmt::format("too few fields: {} of at least 6 ({})", count, kExpected));
  }
  ray.o = {values[0], values[1], values[2]};
  ray.d = {values[3], values[4], values[5]};
  ray.tmin = values[6];
  ray.tmax = values[7];
  if (const auto why = defect(ray)) place.fail(ErrorCode::kBadInput, direction, *why);
  return ray;
}

bool is_header(std::string_view line) {
  const std::string_view first = text::trim(line.substr(0, line.find(',')));
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '"';
  };
  float value = 0.0f;
  return !first.empty() && is_letter(first.front()) &&
         text::parse_float(first, value) == text::Number::kMalformed;
}

/// The columns that a header names. Quotes around a name are those of CSV.
RayColumns parse_header(std::string_view line, const CsvPlace& place) {
  RayColumns columns{.count = 0, .named = true};
  std::array<bool, kFields.size()> seen = {};
  for_each_field(line, [&](const CsvField& at) {
    std::string_view name = at.text;
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"')
      name = name.substr(1, name.size() - 2);
    const auto found = std::find(kFields.begin(), kFields.end(), name);
    if (found == kFields.end())
      place.fail(ErrorCode::kFile, at.column,
                 fmt::format("unknown column {}; {}", in_quotes(name), kExpectedNames));
    const auto field = static_cast<std::size_t>(found - kFields.begin());
    if (seen[field])
      place.fail(ErrorCode::kFile, at.column,
                 fmt::format("column '{}' is there twice; {}", name, kExpectedNames));
    seen[field] = true;
    columns.field[columns.count++] = field;
  });
  for (std::size_t field = 0; field < kNeeded; ++field) {
    if (!seen[field])
      place.fail(ErrorCode::kFile, line.size() + 1,
                 fmt::format("column '{}' is missing; {}", kFields[field], kExpectedNames));
  }
  return columns;
}

std::vector<Ray> parse_rays(std::string_view bytes, std::string_view name) {
  text::require_utf8(bytes, name);
  std::vector<Ray> rays;
  text::Lines lines(text::without_mark(bytes));
  RayColumns columns;
  bool may_be_header = true;
  while (const auto line = lines.next()) {
    const std::string_view content = text::trim(*line);
    if (content.empty() || content.front() == '#') continue;
    const CsvPlace place{name, lines.number()};
    if (std::exchange(may_be_header, false) && is_header(content))
      columns = parse_header(*line, place);
    else
      rays.push_back(parse_line(*line, place, columns));
  }
  return rays;
}

}  // namespace

std::vector<Ray> read_rays_csv(const std::filesystem::path& path) {
  return parse_rays(file_io::read(path), printable_name(path.string()));
}

std::vector<Ray> read_rays_csv(std::istream& in, std::string_view name) {
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) throw Error(ErrorCode::kFile, fmt::format("{}: cannot be read", name));
  return parse_rays(bytes, name);
}

Ray parse_ray(std::string_view text, std::string_view name) {
  return parse_line(text, {name, 0}, {});
}

}  // namespace cde
