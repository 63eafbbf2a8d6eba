// SPDX-License-Identifier: Apache-2.0
#include "cde/io/record_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "cde/contract/records.hpp"
#include "cde/geometry/surface_point.hpp"
#include "cde/io/npy.hpp"
#include "cde/support/columns.hpp"
#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suffix.hpp"
#include "cde/support/suggest.hpp"

namespace cde {
namespace {

/// A record for the names and types of columns; no primary has its number.
const Record kHeader{.primary = ~0u};

constexpr std::array kNames = {"u", "v", "normal", "side", "node", "inside"};

/// The secondary that was hit.
struct Index {
  std::uint32_t value;
  bool f;
};
/// The word of a number.
struct Hex {
  float value;
};

template <class T>
constexpr bool kIsVector = std::is_same_v<T, Eigen::Vector3f>;

/// Cells are called with the name and the value of each column. Text cells end with a comma.
struct CsvHead {
  std::string& to;
  template <class T>
  void operator()(std::string_view name, const T&) const {
    if constexpr (kIsVector<T>)
      for (const char axis : {'x', 'y', 'z'})
        fmt::format_to(std::back_inserter(to), "{}{},", name == "normal" ? "n" : name, axis);
    else
      fmt::format_to(std::back_inserter(to), "{},", name);
  }
};

struct CsvRow {
  std::string& to;
  template <class T>
  void operator()(std::string_view, const T& value) const {
    const auto out = std::back_inserter(to);
    if constexpr (kIsVector<T>)
      fmt::format_to(out, "{},{},{},", value.x(), value.y(), value.z());
    else if constexpr (std::is_same_v<T, Hex>)
      fmt::format_to(out, "{:08x},", std::bit_cast<std::uint32_t>(value.value));
    else if constexpr (std::is_same_v<T, Index>)
      fmt::format_to(out, "{},", value.value);
    else if constexpr (std::is_same_v<T, std::string_view>)
      fmt::format_to(out, "{},", csv_field(printable_name(value)));
    else
      fmt::format_to(out, "{:d},", value);
  }
  void operator()(std::string_view, float value) const {
    fmt::format_to(std::back_inserter(to), "{},", value);
  }
};

struct JsonRow {
  std::string& to;
  template <class T>
  void operator()(std::string_view name, const T& value) const {
    fmt::format_to(std::back_inserter(to), R"("{}":{},)", name, text(value));
  }
  /// JSON has no infinity and no NaN.
  static std::string text(float x) { return std::isfinite(x) ? fmt::format("{}", x) : "null"; }
  static std::string text(const Eigen::Vector3f& v) {
    return fmt::format("[{},{},{}]", text(v.x()), text(v.y()), text(v.z()));
  }
  static std::string text(Index i) {
    return i.f && i.value != ~0u ? fmt::to_string(i.value) : "null";
  }
  static std::string text(std::string_view name) {
    return json_text(nlohmann::ordered_json(name), -1);
  }
  template <std::integral T>
  static std::string text(T value) {
    return fmt::format("{:d}", value);
  }
  static std::string text(Hex h) { return text(h.value); }
};

struct NpyType {
  std::string& to;
  std::size_t name_bytes;
  template <class T>
  void operator()(std::string_view name, const T&) const {
    const std::string type = std::is_same_v<T, bool>          ? "'|b1'"
                             : std::is_same_v<T, std::int8_t> ? "'|i1'"
                             : std::is_same_v<T, float>       ? "'<f4'"
                             : kIsVector<T>                   ? "'<f4', (3,)"
                             : std::is_same_v<T, std::string_view>
                                 ? fmt::format("'|S{}'", name_bytes)
                                 : "'<u4'";
    fmt::format_to(std::back_inserter(to), "{}('{}', {})", to.empty() ? "" : ", ", name, type);
  }
};

struct Bytes {
  std::string& to;
  std::size_t name_bytes;
  template <class T>
  void operator()(std::string_view, const T& value) const {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void operator()(std::string_view, Index i) const { (*this)("", i.value); }
  void operator()(std::string_view, const Eigen::Vector3f& v) const {
    for (const float x : v) (*this)("", x);
  }
  void operator()(std::string_view, std::string_view text) const {
    to.append(text).append(name_bytes - text.size(), '\0');
  }
};

std::vector<RecordField> parse_fields(const std::vector<std::string>& fields) {
  std::vector<RecordField> all;
  for (const std::string& text : fields) {
    check_known(text, field_names(), "field");
    const auto field =
        static_cast<RecordField>(std::find(kNames.begin(), kNames.end(), text) - kNames.begin());
    if (std::find(all.begin(), all.end(), field) != all.end())
      throw Error(ErrorCode::kUsage, fmt::format("--fields has '{}' twice", text));
    all.push_back(field);
  }
  return all;
}

RecordFormat::Kind kind_of(const std::string& path) {
  const Suffix name = suffix_of(path);
  if (name.text == ".npy") return RecordFormat::Kind::kNpy;
  if (name.text == ".jsonl") return RecordFormat::Kind::kJsonLines;
  if (name.nameless || name.text == ".csv") return RecordFormat::Kind::kCsv;
  wrong_suffix("--output", path, ".csv, .npy or .jsonl");
}

}  // namespace

std::vector<std::string> field_names() {
  return {kNames.begin(), kNames.end()};
}

RecordFormat RecordFormat::of_cast(const std::string& path, bool bits,
                                   const std::vector<std::string>& fields) {
  RecordFormat format{.bits = bits, .fields = parse_fields(fields)};
  if (!fields.empty() && path.empty()) throw Error(ErrorCode::kUsage, "--fields needs --output");
  if (path.empty()) return format;
  format.kind = kind_of(path);
  if (format.kind != Kind::kCsv && bits)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("--bits cannot be combined with --output {}; .npy has every bit, .jsonl "
                    "shortest decimals",
                    printable_name(path)));
  return format;
}

RecordText::RecordText(RecordFormat format, const Mesh* mesh, RayView rays)
    : format_(std::move(format)), mesh_(mesh), rays_(std::move(rays)) {
  if (mesh_ == nullptr) return;
  for (const MeshPart& part : mesh_->parts) node_bytes_ = std::max(node_bytes_, part.name.size());
  if (!has(RecordField::kInside)) return;
  // In modes all and hits the records of a ray follow one another.
  is_inside_ = [inside = std::make_shared<const Inside>(*mesh_), rays = rays_,
                last = std::optional<std::pair<std::uint32_t, bool>>()](std::uint32_t,
                                                                        std::uint32_t ray) mutable {
    if (!last || last->first != ray) last = {ray, inside->contains(rays[ray].o)};
    return last->second;
  };
}

RecordText::RecordText(RecordFormat format, IsInside is_inside)
    : format_(std::move(format)), mesh_(nullptr), is_inside_(std::move(is_inside)) {}

bool RecordText::has(RecordField field) const {
  return std::find(format_.fields.begin(), format_.fields.end(), field) != format_.fields.end();
}

template <class Cells>
void RecordText::fields(const Record& r, std::uint32_t frame, const Cells& cells) const {
  SurfacePoint hit;
  std::string_view node;
  if (r.f && mesh_ != nullptr) {
    hit = surface_point(mesh_->triangle(r.index), r.cp, rays_[r.primary].d);
    const auto after = std::upper_bound(
        mesh_->parts.begin(), mesh_->parts.end(), r.index,
        [](std::uint32_t face, const MeshPart& part) { return face < part.first_face; });
    if (after != mesh_->parts.begin()) node = std::prev(after)->name;
  }
  for (const RecordField f : format_.fields) {
    if (f == RecordField::kU) cells("u", static_cast<float>(hit.u));
    if (f == RecordField::kV) cells("v", static_cast<float>(hit.v));
    if (f == RecordField::kNormal) cells("normal", Eigen::Vector3f(hit.normal.cast<float>()));
    if (f == RecordField::kSide) cells("side", hit.side);
    if (f == RecordField::kNode) cells("node", node);
    if (f == RecordField::kInside)
      cells("inside", r.primary != kHeader.primary && is_inside_(frame, r.primary));
  }
}

template <class Cells>
void RecordText::row(const Record& r, std::uint32_t frame, const Cells& cells) const {
  if (format_.frame) cells("frame", frame);
  const auto normals = [&] {
    if (format_.normals) cells("n", r.n);
  };
  if (format_.kind == RecordFormat::Kind::kWords) {
    cells("CP", r.cp);
    cells("flags", std::uint32_t{r.f} << card::kFlagF | std::uint32_t{r.bad} << card::kFlagBad);
    cells("index", r.index);
    cells("T", r.t);
    cells("primary", r.primary);
    normals();
    if (has(RecordField::kInside))
      cells("inside", std::uint32_t{r.primary != kHeader.primary && is_inside_(frame, r.primary)});
    return;
  }
  cells(format_.scene ? "primary" : "ray", r.primary);
  cells("F", r.f);
  if (format_.scene) cells("bad", r.bad);
  cells("T", r.t);
  cells("CP", r.cp);
  cells("index", Index{r.index, r.f});
  normals();
  if (format_.bits) {
    cells("T_bits", Hex{r.t});
    cells("CPx_bits", Hex{r.cp.x()});
    cells("CPy_bits", Hex{r.cp.y()});
    cells("CPz_bits", Hex{r.cp.z()});
  }
  if (!format_.fields.empty()) fields(r, frame, cells);
}

std::string RecordText::head(std::uint64_t count, bool may_grow) const {
  std::string text;
  if (format_.kind == RecordFormat::Kind::kNpy) {
    row(kHeader, 0, NpyType{text, node_bytes_});
    return npy_header("[" + text + "]", format_.shape.value_or(std::vector{count}), may_grow);
  }
  if (format_.kind != RecordFormat::Kind::kCsv) return text;
  row(kHeader, 0, CsvHead{text});
  text.back() = '\n';
  return text;
}

void RecordText::append(std::span<const Record> records, std::string& to,
                        std::uint32_t frame) const {
  for (const Record& r : records) {
    if (format_.only_hits && !r.f) continue;
    switch (format_.kind) {
      case RecordFormat::Kind::kCsv:
        row(r, frame, CsvRow{to});
        to.back() = '\n';
        break;
      case RecordFormat::Kind::kJsonLines:
        to += '{';
        row(r, frame, JsonRow{to});
        to.back() = '}';
        to += '\n';
        break;
      case RecordFormat::Kind::kNpy:
      case RecordFormat::Kind::kWords:
        row(r, frame, Bytes{to, node_bytes_});
        break;
    }
  }
}

std::size_t RecordText::record_bytes() const {
  std::string bytes;
  row(kHeader, 0, Bytes{bytes, node_bytes_});
  return bytes.size();
}

/// Runs before the first records, so that a failing card leaves nothing on stdout.
void RecordFile::head() {
  if (!std::exchange(has_head_, true)) file_.write(text_.head(count_.value_or(0), !count_));
}

void RecordFile::add(std::span<const Record> records, std::uint32_t frame) {
  bytes_.clear();
  text_.append(records, bytes_, frame);
  add_text(bytes_);
}

void RecordFile::add_text(std::string_view text) {
  written_ += text.size();
  if (is_array() && !count_ && !file_.can_replace_start()) {
    waiting_ += text;
    return;
  }
  head();
  file_.write(text);
}

void RecordFile::commit() {
  const std::uint64_t records = is_array() ? written_ / text_.record_bytes() : 0;
  if (is_array() && count_ && *count_ != records)
    throw Error(ErrorCode::kDevice, fmt::format("{} records came; expected {}", records, *count_));
  if (is_array() && !count_ && !file_.can_replace_start()) {
    file_.write(text_.head(records, true));
    file_.write(waiting_);
  } else {
    head();
    if (is_array() && !count_) file_.replace_start(text_.head(records, true));
  }
  file_.commit();
}

}  // namespace cde
