// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/design.hpp"
#include "cde/support/text_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <sstream>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/elaborated.hpp"
#include "support/file_io.hpp"

namespace cde::wave {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostUnits = 1'000'000;
constexpr unsigned kMostDepth = 200;

/// Adds the instances below an existing unit. `parts` counts all instances, also of missing
/// modules.
void place_parts(Design::Elaborated& all, std::uint32_t unit, unsigned depth, std::size_t& parts,
                 const TextMap<std::uint32_t>& bodies) {
  parts += all.body(unit).parts.size();
  if (depth > kMostDepth || parts > kMostUnits)
    throw netlist::NetlistError("instances are too many or nested too deeply");
  const std::uint32_t body = all.units[unit].body;
  for (std::int64_t outer = all.units[unit].parent; outer >= 0;
       outer = all.units[static_cast<std::size_t>(outer)].parent)
    if (all.units[static_cast<std::size_t>(outer)].body == body)
      throw netlist::NetlistError("a module contains itself");
  for (std::uint32_t p = 0; p < all.bodies[body].parts.size(); ++p) {
    const Part& part = all.bodies[body].parts[p];
    const auto found = bodies.find(part.module);
    if (found == bodies.end()) {
      all.units[unit].parts.push_back(-1);
      continue;
    }
    const auto inner = static_cast<std::uint32_t>(all.units.size());
    all.units[unit].parts.push_back(inner);
    all.units.push_back({found->second, unit, p, {}});
    place_parts(all, inner, depth + 1, parts, bodies);
  }
}

/// Takes "[3]" or "[7:4]" from the beginning of a text.
std::optional<std::pair<int, int>> take_index(std::string_view& text) {
  const std::size_t end = text.find(']');
  if (!text.starts_with('[') || end == std::string_view::npos) return std::nullopt;
  int left = 0, right = 0;
  const char* const stop = text.data() + end;
  const auto a = std::from_chars(text.data() + 1, stop, left);
  if (a.ec != std::errc()) return std::nullopt;
  right = left;
  if (a.ptr != stop) {
    if (*a.ptr != ':') return std::nullopt;
    const auto b = std::from_chars(a.ptr + 1, stop, right);
    if (b.ec != std::errc() || b.ptr != stop) return std::nullopt;
  }
  text.remove_prefix(end + 1);
  return std::pair(left, right);
}

/// The number of an array element or bit, counted from the lowest; -1 if it does not exist.
std::int64_t position(const netlist::Type& type, int index) {
  const int low = std::min(type.left, type.right), high = std::max(type.left, type.right);
  if (index < low || index > high) return -1;
  const bool turned = type.kind != netlist::Type::Kind::kUnpacked && type.left < type.right;
  return turned ? std::int64_t{type.right} - index : std::int64_t{index} - low;
}
int index_at(const netlist::Type& type, std::int64_t position) {
  const bool turned = type.kind != netlist::Type::Kind::kUnpacked && type.left < type.right;
  return static_cast<int>(turned ? type.right - position
                                 : std::min(type.left, type.right) + position);
}

/// Follows [3], [7:4] and .member into a type.
bool take_part(const netlist::Netlist& netlist, unsigned type_id, std::string_view rest, Slice& s) {
  while (!rest.empty()) {
    const netlist::Type& type = netlist.type(type_id);
    if (rest.front() == '.' && type.kind == netlist::Type::Kind::kStructure) {
      const std::size_t end = std::min(rest.find_first_of(".[", 1), rest.size());
      const auto member = std::find_if(
          type.members.begin(), type.members.end(),
          [&](const netlist::Type::Member& m) { return m.name == rest.substr(1, end - 1); });
      if (member == type.members.end()) return false;
      s.low += member->low;
      type_id = member->type;
      s.width = netlist.type(type_id).width;
      rest.remove_prefix(end);
      continue;
    }
    const auto index = take_index(rest);
    if (!index || type.width == 0) return false;
    const bool array =
        type.kind == netlist::Type::Kind::kPacked || type.kind == netlist::Type::Kind::kUnpacked;
    if (!array && type.kind != netlist::Type::Kind::kBits) return false;
    const std::uint64_t one = array ? netlist.type(type.element).width : 1;
    const std::int64_t a = position(type, index->first), b = position(type, index->second);
    if (a < 0 || b < 0 || one == 0) return false;
    s.low += static_cast<std::uint64_t>(std::min(a, b)) * one;
    s.width = (static_cast<std::uint64_t>(std::max(a, b) - std::min(a, b)) + 1) * one;
    if (!array || a != b) return rest.empty();
    type_id = type.element;
  }
  return true;
}

/// The text behind a name that selects these bits of a type.
std::string part_text(const netlist::Netlist& netlist, unsigned type_id, std::uint64_t low,
                      std::uint64_t width) {
  std::string text;
  for (unsigned most = 100; most > 0; --most) {
    const netlist::Type& type = netlist.type(type_id);
    if (type.width == 0 || (low == 0 && width >= type.width)) break;
    if (type.kind == netlist::Type::Kind::kStructure) {
      const auto member =
          std::find_if(type.members.begin(), type.members.end(), [&](const auto& m) {
            return low >= m.low && low + width <= m.low + netlist.type(m.type).width;
          });
      if (member == type.members.end()) return text + fmt::format("{{{}+:{}}}", low, width);
      text += "." + member->name;
      low -= member->low;
      type_id = member->type;
      continue;
    }
    const bool array = type.kind != netlist::Type::Kind::kBits;
    const std::uint64_t one = array ? netlist.type(type.element).width : 1;
    if (one == 0) break;
    const auto first = static_cast<std::int64_t>(low / one);
    const auto last = static_cast<std::int64_t>((low + width - 1) / one);
    if (first != last) {
      const bool whole = low % one == 0 && (low + width) % one == 0;
      text +=
          fmt::format("[{}:{}]{}", index_at(type, last), index_at(type, first), whole ? "" : "~");
      break;
    }
    text += fmt::format("[{}]", index_at(type, first));
    low -= static_cast<std::uint64_t>(first) * one;
    if (!array) break;
    type_id = type.element;
  }
  return text;
}

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

std::string Place::name() const {
  return file.empty() ? "" : fmt::format("{}:{}", fs::path(file).filename().string(), line);
}

Design::Design(std::string xml, const std::string& file) try
    : all_(std::make_unique<Elaborated>(std::move(xml))) {
  all_->file = file;
  TextMap<std::uint32_t> bodies;
  BodyBytes bytes(all_->netlist.bytes());
  std::int64_t top = -1;
  for (const netlist::Element* e : all_->netlist.netlist().children()) {
    if (e->tag() != "module" && e->tag() != "package") continue;
    const auto id = static_cast<std::uint32_t>(all_->bodies.size());
    if (e->attribute("topModule") == "1") top = id;
    bodies.emplace(e->text("name"), id);
    all_->bodies.push_back(read_body(*e, bytes));
  }
  if (top < 0) throw netlist::NetlistError("it has no top module");
  all_->units.push_back({static_cast<std::uint32_t>(top), -1, 0, {}});
  std::size_t parts = 0;
  place_parts(*all_, 0, 0, parts, bodies);
  all_->prefix = all_->bodies[static_cast<std::size_t>(top)].source_name;
} catch (const netlist::NetlistError& e) {
  throw Error(ErrorCode::kFile, fmt::format("{}: not a structure file: {}", printable_name(file),
                                            printable(e.what())));
}
Design::~Design() = default;
Design::Design(Design&&) noexcept = default;

const std::string& Design::prefix() const {
  return all_->prefix;
}

std::string without_array_scope(std::string_view name) {
  std::size_t dot = name.rfind('.');
  const std::string_view last = name.substr(dot == std::string_view::npos ? 0 : dot + 1);
  const std::size_t bracket = last.find('[');
  if (dot == std::string_view::npos || bracket == std::string_view::npos || bracket == 0)
    return std::string(name);
  std::string_view outer = name.substr(0, dot);
  while (outer.ends_with(']') && (dot = outer.rfind(".[")) != std::string_view::npos &&
         outer.find('.', dot + 1) == std::string_view::npos)
    outer = outer.substr(0, dot);
  dot = outer.rfind('.');
  const std::size_t stem = dot == std::string_view::npos ? 0 : dot + 1;
  if (outer.substr(stem) != last.substr(0, bracket)) return std::string(name);
  return std::string(outer.substr(0, stem)).append(last);
}

std::optional<Slice> Design::find(std::string_view name) const {
  const auto found = find_exact(name);
  if (found) return found;
  const std::string plain = without_array_scope(name);
  return plain == name ? std::nullopt : find_exact(plain);
}

std::optional<Slice> Design::find_exact(std::string_view name) const {
  if (!name.starts_with(all_->prefix) || name.size() <= all_->prefix.size() ||
      name[all_->prefix.size()] != '.')
    return std::nullopt;
  name.remove_prefix(all_->prefix.size() + 1);
  std::uint32_t unit = 0;
  for (std::size_t dot = name.find('.'); dot != std::string_view::npos;) {
    const Body& body = all_->body(unit);
    const auto part = body.part_by_path.find(name.substr(0, dot));
    if (part == body.part_by_path.end()) {
      dot = name.find('.', dot + 1);
      continue;
    }
    const std::int64_t inner = all_->units[unit].parts[part->second];
    if (inner < 0) return std::nullopt;
    unit = static_cast<std::uint32_t>(inner);
    name.remove_prefix(dot + 1);
    dot = name.find('.');
  }
  // The longest prefix that is a variable; the rest selects a part of it.
  const Body& body = all_->body(unit);
  for (std::size_t end = name.size(); end != 0 && end != std::string_view::npos;
       end = end == 0 ? 0 : name.find_last_of(".[", end - 1)) {
    const auto found = body.by_path.find(name.substr(0, end));
    if (found == body.by_path.end()) continue;
    Slice s = all_->whole(unit, found->second);
    if (s.width != 0 &&
        take_part(all_->netlist, body.variables[found->second].type, name.substr(end), s))
      return s;
    return std::nullopt;
  }
  return std::nullopt;
}

std::string Design::Elaborated::path(std::uint32_t unit) const {
  std::vector<std::uint32_t> inside;  // the innermost first
  for (; units[unit].parent >= 0; unit = static_cast<std::uint32_t>(units[unit].parent))
    inside.push_back(unit);
  std::string path;
  for (auto u = inside.rbegin(); u != inside.rend(); ++u) {
    const auto outer = static_cast<std::uint32_t>(units[*u].parent);
    path.append(body(outer).parts[units[*u].part].path).push_back('.');
  }
  return path;
}

std::string Design::instance(const Slice& s) const {
  return fmt::format("{}.{}", all_->prefix, all_->path(s.unit));
}

std::string Design::variable_name(const Slice& s) const {
  return instance(s) + all_->variable(s).path;
}

std::string Design::local_name(const Slice& s) const {
  return all_->variable(s).path + part_text(all_->netlist, all_->variable(s).type, s.low, s.width);
}

std::string Design::name(const Slice& s) const {
  return instance(s) + local_name(s);
}

bool Design::is_hidden(const Slice& s) const {
  return all_->variable(s).local;
}

bool Design::is_input(const Slice& s) const {
  return s.unit == 0 && all_->variable(s).input;
}

std::vector<Design::Piece> Design::pieces(
    const Slice& s, const std::function<bool(const std::string&)>& exists) const {
  struct Walk {
    const netlist::Netlist& netlist;
    const Slice& wanted;
    std::vector<Piece>& found;
    const std::function<bool(const std::string&)>& exists;
    std::uint64_t& steps;  ///< left; a type can have 2^30 elements in a line of a structure
    void operator()(const std::string& name, unsigned type_id, std::uint64_t low, int depth) const {
      const netlist::Type& type = netlist.type(type_id);
      if (steps == 0) return;
      --steps;
      if (depth > 20 || type.width == 0 || low >= wanted.low + wanted.width ||
          low + type.width <= wanted.low)
        return;
      if (exists(name)) {
        found.push_back({name, {wanted.unit, wanted.variable, low, type.width}});
      } else if (type.kind == netlist::Type::Kind::kStructure) {
        for (const netlist::Type::Member& m : type.members)
          (*this)(name + "." + m.name, m.type, low + m.low, depth + 1);
      } else if (type.kind == netlist::Type::Kind::kPacked ||
                 type.kind == netlist::Type::Kind::kUnpacked) {
        const std::uint64_t one = netlist.type(type.element).width;
        if (one == 0) return;
        const std::uint64_t first = wanted.low > low ? (wanted.low - low) / one : 0;
        const std::uint64_t last =
            std::min(type.width / one, (wanted.low + wanted.width - low - 1) / one + 1);
        for (std::uint64_t i = first; i < last && found.size() < 4096 && steps > 0; ++i)
          (*this)(fmt::format("{}[{}]", name, index_at(type, static_cast<std::int64_t>(i))),
                  type.element, low + i * one, depth + 1);
      }
    }
  };
  std::vector<Piece> found;
  std::uint64_t steps = 1 << 20;
  Walk{all_->netlist, s, found, exists, steps}(variable_name(s), all_->variable(s).type, 0, 0);
  return found;
}

namespace {

/// The text of a source that a structure names; nothing if it may not be read. The structure of a
/// stranger must not print other files.
std::optional<std::string> source_text(const fs::path& path, std::optional<uid_t> stranger) {
  constexpr std::uint64_t kMost = 16u << 20;
  const std::string suffix = path.extension().string();
  if (suffix != ".sv" && suffix != ".v" && suffix != ".svh" && suffix != ".vh") return std::nullopt;
  try {
    uid_t owner = 0;
    std::string text = file_io::read_regular(path, kMost, &owner);
    if (stranger && owner != *stranger) return std::nullopt;
    return text;
  } catch (const Error&) {
    return std::nullopt;  // causes are then printed without lines of the source
  }
}

}  // namespace

const std::vector<std::string>& Design::Elaborated::source(const std::string& name) const {
  const auto [at, fresh] = sources.try_emplace(name);
  if (!fresh || name.empty() || name.front() == '<') return at->second;
  for (const fs::path& path : {fs::path(name), fs::path(file).parent_path() / name}) {
    std::istringstream in(source_text(path, stranger).value_or(""));
    for (std::string line; std::getline(in, line);) at->second.push_back(line);
    if (!at->second.empty()) break;
  }
  return at->second;
}
const std::vector<std::string>& Design::source(const std::string& file) const {
  return all_->source(file);
}

Place place_of(const Design& design, const netlist::Netlist& netlist, const netlist::Element* e) {
  if (e == nullptr) return {};
  const netlist::Line line = netlist.line(*e);
  Place place{line.file, line.line, {}};
  const auto& text = design.source(line.file);
  if (line.line >= 1 && line.line <= text.size()) place.text = trimmed(text[line.line - 1]);
  return place;
}

Place Design::declaration(const Slice& s) const {
  return place_of(*this, all_->netlist, all_->variable(s).declared);
}

}  // namespace cde::wave
