#include "cde/rays_csv.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>

#include "cde/error.hpp"
#include "file_io.hpp"
#include "text.hpp"

namespace cde {
namespace {

constexpr std::array<std::string_view, 8> kFields = {"ox", "oy", "oz",   "dx",
                                                     "dy", "dz", "tmin", "tmax"};
constexpr std::size_t kNeeded = 6;

/// Where a message points: "rays.csv:12:7" or "--ray:7".
struct Place {
  std::string_view name;
  std::size_t line;  // 0: the text is a single line without a number

  [[noreturn]] void fail(ErrorCode code, std::size_t column, const std::string& why) const {
    if (line == 0) throw Error(code, fmt::format("{}:{}: {}", name, column, why));
    throw Error(code, fmt::format("{}:{}:{}: {}", name, line, column, why));
  }
};

/// The blank-trimmed text before the next comma, and its column from 1.
struct Field {
  std::string_view text;
  std::size_t column;
};

std::size_t split(std::string_view line, std::array<Field, kFields.size()>& fields,
                  const Place& place) {
  std::size_t count = 0;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = line.find(',', start);
    const std::string_view raw =
        line.substr(start, comma == std::string_view::npos ? comma : comma - start);
    const std::string_view field = text::trim(raw);
    const std::size_t lead =
        field.empty() ? 0 : static_cast<std::size_t>(field.data() - raw.data());
    if (count == fields.size()) {
      place.fail(ErrorCode::kFile, start + lead + 1,
                 "too many fields: a ray has 6 to 8 (ox,oy,oz,dx,dy,dz[,tmin[,tmax]])");
    }
    fields[count++] = {field, start + lead + 1};
    if (comma == std::string_view::npos) return count;
    start = comma + 1;
  }
}

Ray parse_line(std::string_view line, const Place& place) {
  std::array<Field, kFields.size()> fields;
  const std::size_t count = split(line, fields, place);
  Ray ray;
  std::array<float, kFields.size()> values = {0, 0, 0, 0, 0, 0, ray.tmin, ray.tmax};
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [text, column] = fields[i];
    if (text.empty()) place.fail(ErrorCode::kFile, column, fmt::format("{} is empty", kFields[i]));
    const text::Number result = text::parse_float(text, values[i]);
    if (result == text::Number::kOverflow) {
      place.fail(ErrorCode::kFile, column,
                 fmt::format("{}: {} overflows a float", kFields[i], text::quoted(text)));
    }
    if (result != text::Number::kOk) {
      place.fail(ErrorCode::kFile, column,
                 fmt::format("{}: {} is not a number", kFields[i], text::quoted(text)));
    }
    if (std::isnan(values[i]))
      place.fail(ErrorCode::kBadInput, column, fmt::format("{} is nan", kFields[i]));
    if (i < kNeeded && std::isinf(values[i]))
      place.fail(ErrorCode::kBadInput, column, fmt::format("{} is infinite", kFields[i]));
  }
  if (count < kNeeded) {
    place.fail(
        ErrorCode::kFile, line.size() + 1,
        fmt::format("too few fields: {} of at least 6 (ox,oy,oz,dx,dy,dz[,tmin[,tmax]])", count));
  }
  ray.o = {values[0], values[1], values[2]};
  ray.d = {values[3], values[4], values[5]};
  ray.tmin = values[6];
  ray.tmax = values[7];
  if (const auto why = defect(ray)) place.fail(ErrorCode::kBadInput, fields[3].column, *why);
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

std::vector<Ray> parse(std::string_view bytes, std::string_view name) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  std::vector<Ray> rays;
  text::Lines lines(bytes);
  bool may_be_header = true;
  while (const auto line = lines.next()) {
    const std::string_view content = text::trim(*line);
    if (content.empty() || content.front() == '#') continue;
    const bool header = may_be_header && is_header(content);
    may_be_header = false;
    if (!header) rays.push_back(parse_line(*line, {name, lines.number()}));
  }
  return rays;
}

}  // namespace

std::vector<Ray> read_rays_csv(const std::filesystem::path& path) {
  return parse(file_io::read(path), path.string());
}

std::vector<Ray> read_rays_csv(std::istream& in, std::string_view name) {
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) throw Error(ErrorCode::kFile, fmt::format("{}: cannot be read", name));
  return parse(bytes, name);
}

Ray parse_ray(std::string_view text, std::string_view name) {
  return parse_line(text, {name, 0});
}

}  // namespace cde
