// SPDX-License-Identifier: Apache-2.0
#include "cde/io/record_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "cde/io/npy.hpp"
#include "cde/support/error.hpp"
#include "cde/support/suffix.hpp"
#include "cde/support/suggest.hpp"

namespace cde {
namespace {

constexpr std::array kNames = {"u", "v", "normal", "side", "node"};

template <class T>
void append(fmt::memory_buffer& to, const T& value) {
  const char* bytes = reinterpret_cast<const char*>(&value);
  to.append(bytes, bytes + sizeof(T));
}

/// A name from a file in a field of CSV.
std::string csv_text(std::string_view name) {
  if (name.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(name);
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// JSON has no infinity and no NaN.
std::string json_number(float x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "null";
}

}  // namespace

std::vector<std::string> field_names() {
  return {kNames.begin(), kNames.end()};
}

RecordFile::Kind RecordFile::kind_of(const std::string& path) {
  const Suffix name = suffix_of(path);
  if (name.nameless || name.text == ".csv") return Kind::kCsv;
  if (name.text == ".npy") return Kind::kNpy;
  if (name.text == ".jsonl") return Kind::kJsonLines;
  wrong_suffix("--output", path, ".csv, .npy or .jsonl");
}

std::vector<RecordField> RecordFile::parse(const std::vector<std::string>& fields) {
  std::vector<RecordField> all;
  for (const std::string& text : fields) {
    must_be_known(text, field_names(), "field");
    const auto field =
        static_cast<RecordField>(std::find(kNames.begin(), kNames.end(), text) - kNames.begin());
    if (std::find(all.begin(), all.end(), field) != all.end())
      throw Error(ErrorCode::kUsage, fmt::format("--fields has '{}' twice", text));
    all.push_back(field);
  }
  return all;
}

void RecordFile::check(const std::string& path, bool bits, const std::vector<std::string>& fields) {
  if (!parse(fields).empty() && path.empty())
    throw Error(ErrorCode::kUsage, "--fields is of records; give --output too");
  if (path.empty()) return;
  if (kind_of(path) != Kind::kCsv && bits)
    throw Error(ErrorCode::kUsage,
                "--bits is of CSV; .npy has every bit, .jsonl shortest decimals");
}

RecordFile::RecordFile(const std::string& path, bool bits, const std::vector<std::string>& fields,
                       const Mesh& mesh, const RayView& rays, std::optional<std::uint64_t> count)
    : kind_(kind_of(path)),
      bits_(bits),
      fields_(parse(fields)),
      mesh_(mesh),
      rays_(rays),
      count_(count),
      file_(path) {
  for (const MeshPart& part : mesh_.parts) node_bytes_ = std::max(node_bytes_, part.name.size());
}

std::string RecordFile::npy_fields() const {
  std::string fields =
      "[('ray', '<u4'), ('F', '|b1'), ('T', '<f4'), ('CP', '<f4', (3,)), ('index', '<u4')";
  for (const RecordField f : fields_) {
    switch (f) {
      case RecordField::kU:
        fields += ", ('u', '<f4')";
        break;
      case RecordField::kV:
        fields += ", ('v', '<f4')";
        break;
      case RecordField::kNormal:
        fields += ", ('normal', '<f4', (3,))";
        break;
      case RecordField::kSide:
        fields += ", ('side', '|i1')";
        break;
      case RecordField::kNode:
        fields += fmt::format(", ('node', '|S{}')", node_bytes_);
        break;
    }
  }
  return fields + "]";
}

/// Before the first records, so that a card that fails leaves nothing on stdout.
void RecordFile::head() {
  if (std::exchange(has_head_, true)) return;
  if (kind_ == Kind::kNpy) file_.write(npy_header(npy_fields(), {*count_}));
  if (kind_ != Kind::kCsv) return;
  std::string line = "ray,F,T,CPx,CPy,CPz,index";
  if (bits_) line += ",T_bits,CPx_bits,CPy_bits,CPz_bits";
  for (const RecordField f : fields_)
    line += f == RecordField::kNormal ? std::string(",nx,ny,nz")
                                      : fmt::format(",{}", kNames[static_cast<std::size_t>(f)]);
  file_.write(line + "\n");
}

RecordFile::Details RecordFile::details(const Record& r) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Details d{kNone, kNone, Eigen::Vector3d::Constant(kNone), 0, {}};
  if (!r.f) return d;
  const Triangle t = mesh_.triangle(r.index);
  const Eigen::Vector3d a = t.v0.cast<double>(), ab = t.v1.cast<double>() - a,
                        ac = t.v2.cast<double>() - a, ap = r.cp.cast<double>() - a;
  const Eigen::Vector3d n = ab.cross(ac);
  d.u = ap.cross(ac).dot(n) / n.squaredNorm();
  d.v = ab.cross(ap).dot(n) / n.squaredNorm();
  d.normal = n.normalized();
  const double towards = n.dot(rays_[r.primary].d.cast<double>());
  d.side = towards < 0 ? 1 : towards > 0 ? -1 : 0;
  const auto after = std::upper_bound(
      mesh_.parts.begin(), mesh_.parts.end(), r.index,
      [](std::uint32_t face, const MeshPart& part) { return face < part.first_face; });
  if (after != mesh_.parts.begin()) d.node = std::prev(after)->name;
  return d;
}

void RecordFile::csv(const Record& r) {
  const auto out = std::back_inserter(text_);
  fmt::format_to(out, "{},{},{},{},{},{},{}", r.primary, r.f ? 1 : 0, r.t, r.cp.x(), r.cp.y(),
                 r.cp.z(), r.index);
  if (bits_)
    for (const float x : {r.t, r.cp.x(), r.cp.y(), r.cp.z()})
      fmt::format_to(out, ",{:08x}", std::bit_cast<std::uint32_t>(x));
  if (!fields_.empty()) {
    const Details d = details(r);
    for (const RecordField f : fields_) {
      if (f == RecordField::kU) fmt::format_to(out, ",{}", static_cast<float>(d.u));
      if (f == RecordField::kV) fmt::format_to(out, ",{}", static_cast<float>(d.v));
      if (f == RecordField::kNormal)
        for (const double x : d.normal) fmt::format_to(out, ",{}", static_cast<float>(x));
      if (f == RecordField::kSide) fmt::format_to(out, ",{}", d.side);
      if (f == RecordField::kNode) fmt::format_to(out, ",{}", csv_text(d.node));
    }
  }
  text_.push_back('\n');
}

void RecordFile::npy(const Record& r) {
  append(text_, r.primary);
  append(text_, static_cast<std::uint8_t>(r.f ? 1 : 0));
  for (const float x : {r.t, r.cp.x(), r.cp.y(), r.cp.z()}) append(text_, x);
  append(text_, r.index);
  if (fields_.empty()) return;
  const Details d = details(r);
  for (const RecordField f : fields_) {
    if (f == RecordField::kU) append(text_, static_cast<float>(d.u));
    if (f == RecordField::kV) append(text_, static_cast<float>(d.v));
    if (f == RecordField::kNormal)
      for (const double x : d.normal) append(text_, static_cast<float>(x));
    if (f == RecordField::kSide) append(text_, static_cast<std::int8_t>(d.side));
    if (f == RecordField::kNode) {
      std::string name(d.node);
      name.resize(node_bytes_, '\0');
      text_.append(name);
    }
  }
}

void RecordFile::json_line(const Record& r) {
  const auto out = std::back_inserter(text_);
  fmt::format_to(out, R"({{"ray":{},"F":{},"T":{},"CP":[{},{},{}],"index":{})", r.primary,
                 r.f ? 1 : 0, json_number(r.t), json_number(r.cp.x()), json_number(r.cp.y()),
                 json_number(r.cp.z()), r.f && r.index != ~0u ? fmt::to_string(r.index) : "null");
  if (!fields_.empty()) {
    const Details d = details(r);
    const auto number = [](double x) { return json_number(static_cast<float>(x)); };
    for (const RecordField f : fields_) {
      if (f == RecordField::kU) fmt::format_to(out, R"(,"u":{})", number(d.u));
      if (f == RecordField::kV) fmt::format_to(out, R"(,"v":{})", number(d.v));
      if (f == RecordField::kNormal)
        fmt::format_to(out, R"(,"normal":[{},{},{}])", number(d.normal.x()), number(d.normal.y()),
                       number(d.normal.z()));
      if (f == RecordField::kSide) fmt::format_to(out, R"(,"side":{})", d.side);
      if (f == RecordField::kNode)
        fmt::format_to(
            out, R"(,"node":{})",
            nlohmann::json(d.node).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    }
  }
  text_.append(std::string_view("}\n"));
}

void RecordFile::add(std::span<const Record> records) {
  // Without a count, an array has its header last, so its data wait in memory.
  const bool waits = kind_ == Kind::kNpy && !count_;
  if (!waits) text_.clear();
  for (const Record& r : records) {
    if (kind_ == Kind::kCsv) csv(r);
    if (kind_ == Kind::kNpy) npy(r);
    if (kind_ == Kind::kJsonLines) json_line(r);
  }
  written_ += records.size();
  if (!waits) head();
  if (!waits) file_.write({text_.data(), text_.size()});
}

void RecordFile::commit() {
  if (kind_ == Kind::kNpy && !count_) {
    count_ = written_;
    head();
    file_.write({text_.data(), text_.size()});
  }
  head();
  if (kind_ == Kind::kNpy && *count_ != written_)
    throw Error(ErrorCode::kDevice, fmt::format("{} records came of {}", written_, *count_));
  file_.commit();
}

}  // namespace cde
