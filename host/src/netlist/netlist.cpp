// SPDX-License-Identifier: Apache-2.0
#include "cde/netlist/netlist.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <utility>

namespace cde::netlist {
namespace {

constexpr std::size_t kMostOpen = 4000;    // nested elements
constexpr unsigned kMostTypeDepth = 1000;  // nested types
constexpr std::uint64_t kMostBits = 1u << 30;

struct Entity {
  std::string_view name;
  char character;
};
constexpr std::array<Entity, 5> kEntities = {
    {{"&apos;", '\''}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&amp;", '&'}}};

std::string without_entities(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) {
    const auto entity = std::find_if(kEntities.begin(), kEntities.end(),
                                     [&](const Entity& e) { return text.starts_with(e.name); });
    plain.push_back(entity == kEntities.end() ? text.front() : entity->character);
    text.remove_prefix(entity == kEntities.end() ? 1 : entity->name.size());
  }
  return plain;
}

int signed_number(std::string_view text) {
  int value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// A constant of at most 32 bits, as used in ranges.
int small_constant(const Element* constant) {
  if (constant == nullptr) return 0;
  std::uint32_t value = 0;
  for (const char c : constant_bits(*constant)) value = value << 1 | (c == '1' ? 1u : 0u);
  return static_cast<int>(value);
}

std::uint64_t length(int left, int right) {
  return static_cast<std::uint64_t>(std::abs(std::int64_t{left} - right)) + 1;
}

}  // namespace

std::string_view Element::attribute(std::string_view name) const {
  for (std::size_t at = 0;;) {
    at = attributes_.find(name, at);
    if (at == std::string_view::npos || at == 0) return {};
    const std::size_t value = at + name.size() + 2;
    if (attributes_[at - 1] == ' ' && attributes_.substr(at + name.size(), 2) == "=\"")
      return attributes_.substr(value, attributes_.find('"', value) - value);
    at = value - 1;
    if (at >= attributes_.size()) return {};
  }
}

std::string Element::text(std::string_view name) const {
  return without_entities(attribute(name));
}

unsigned Element::number(std::string_view name) const {
  const std::string_view text = attribute(name);
  unsigned value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Netlist::Netlist(std::string xml) : text_(std::make_unique<const std::string>(std::move(xml))) {
  const std::string_view text = *text_;
  std::vector<Element*> open;
  const Element* types = nullptr;
  bool begun = false, ended = false;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    const bool comment = text.substr(at).starts_with("<!--");
    const std::size_t stop = text.find(comment ? std::string_view("-->") : ">", at);
    if (stop == std::string_view::npos) break;
    std::string_view element = text.substr(at + 1, stop - at - 1);
    at = stop;
    if (comment || element.empty() || element.front() == '?') continue;
    if (element.front() == '/') {
      if (open.empty() || open.back()->tag_ != element.substr(1))
        throw NetlistError("elements are not closed in order");
      ended = open.size() == 1;
      open.pop_back();
      continue;
    }
    const bool empty = element.back() == '/';
    if (empty) element.remove_suffix(1);
    if (open.size() >= kMostOpen) throw NetlistError("elements are nested too deeply");
    Element& e = elements_.emplace_back();
    e.tag_ = element.substr(0, element.find_first_of(" \n\t"));
    e.attributes_ = element.substr(e.tag_.size());
    if (open.empty() && std::exchange(begun, true)) throw NetlistError("it has several roots");
    if (open.empty() && e.tag_ != "verilator_xml")
      throw NetlistError("it is not what verilator --xml-only writes");
    if (!open.empty()) open.back()->children_.push_back(&e);
    if (e.tag_ == "netlist") netlist_ = &e;
    if (e.tag_ == "cells") cells_ = &e;
    if (e.tag_ == "typetable") types = &e;
    if (e.tag_ == "file") files_.emplace(e.attribute("id"), e.text("filename"));
    if (!empty) open.push_back(&e);
  }
  if (!begun) throw NetlistError("it is not what verilator --xml-only writes");
  if (!ended) throw NetlistError("it is truncated");
  if (netlist_ == nullptr || cells_ == nullptr || types == nullptr)
    throw NetlistError("it has no netlist");
  read_types(*types);
}

Line Netlist::line(const Element& element) const {
  // c,12,7,12,19: letters of the file, first line and column, last line and column
  const std::string_view location = element.attribute("loc");
  const std::size_t comma = std::min(location.find(','), location.size());
  const auto file = files_.find(location.substr(0, comma));
  if (file == files_.end() || comma == location.size()) return {};
  std::array<unsigned, 4> at = {};
  std::size_t from = comma;
  for (unsigned& number : at) {
    if (from == std::string_view::npos) break;
    number = static_cast<unsigned>(signed_number(location.substr(from + 1)));
    from = location.find(',', from + 1);
  }
  const bool one_line = at[0] == at[2] && at[1] < at[3];
  return {file->second, at[0], at[1], one_line ? at[3] - at[1] : 0};
}

const Type& Netlist::type(unsigned id) const {
  static const Type kNone;
  for (unsigned most = 100; most > 0; --most) {
    const auto alias = aliases_.find(id);
    if (alias == aliases_.end()) break;
    id = alias->second;
  }
  const auto found = types_.find(id);
  return found == types_.end() ? kNone : found->second;
}

void Netlist::read_types(const Element& table) {
  for (const Element* e : table.children()) {
    const unsigned id = e->number("id");
    Type type;
    if (e->tag() == "basicdtype") {
      type.kind = Type::Kind::kBits;
      type.left = signed_number(e->attribute("left"));
      type.right = signed_number(e->attribute("right"));
      type.width = length(type.left, type.right);
    } else if (e->tag() == "packarraydtype" || e->tag() == "unpackarraydtype") {
      type.kind = e->tag() == "packarraydtype" ? Type::Kind::kPacked : Type::Kind::kUnpacked;
      type.element = e->number("sub_dtype_id");
      if (const Element* range = e->child(0)) {
        type.left = small_constant(range->child(0));
        type.right = small_constant(range->child(1));
      }
    } else if (e->tag() == "structdtype") {
      type.kind = Type::Kind::kStructure;
      for (const Element* member : e->children())
        type.members.push_back({member->text("name"), member->number("sub_dtype_id")});
    } else if (!e->attribute("sub_dtype_id").empty()) {  // an enumeration, or a name for a type
      aliases_.emplace(id, e->number("sub_dtype_id"));
      continue;
    }
    types_.emplace(id, std::move(type));
  }
  // A type may precede the type of its elements.
  for (const auto& [id, type] : types_) (void)width(id, 0);
  measured_.clear();
}

std::uint64_t Netlist::width(unsigned id, unsigned depth) {
  for (unsigned most = 100; most > 0 && aliases_.contains(id); --most) id = aliases_.at(id);
  const auto found = types_.find(id);
  if (found == types_.end()) return 0;
  Type& type = found->second;
  // A type that contains itself has no known width.
  if (type.width != 0 || depth > kMostTypeDepth || !measured_.insert(id).second) return type.width;
  if (type.kind == Type::Kind::kPacked || type.kind == Type::Kind::kUnpacked) {
    const std::uint64_t one = width(type.element, depth + 1), n = length(type.left, type.right);
    if (one <= kMostBits && n <= kMostBits && one * n <= kMostBits) type.width = one * n;
  } else if (type.kind == Type::Kind::kStructure) {
    std::uint64_t all = 0;
    for (auto member = type.members.rbegin(); member != type.members.rend(); ++member) {
      member->low = static_cast<unsigned>(all);
      const std::uint64_t one = width(member->type, depth + 1);
      if (one == 0 || all + one > kMostBits) return 0;
      all += one;
    }
    type.width = all;
  }
  return type.width;
}

std::string constant_bits(const Element& constant) {
  // 32'sh1f, 4'b1x0z, 8'h00. An x or z digit that is not binary stands for all bits of the digit.
  const std::string text = constant.text("name");
  const std::size_t quote = text.find('\'');
  if (constant.tag() != "const" || quote == std::string::npos || quote == 0) return {};
  std::size_t at = quote + 1;
  if (at < text.size() && text[at] == 's') ++at;
  const char base = at < text.size() ? text[at++] : '?';
  const int width = signed_number(text);
  if ((base != 'h' && base != 'b') || width <= 0 || width > (1 << 24)) return {};
  std::string bits;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == 'x' || c == 'z' || base == 'b') {
      bits.append(base == 'b' ? 1 : 4, c);
      continue;
    }
    if (std::isxdigit(static_cast<unsigned char>(c)) == 0) return {};
    const int digit = c <= '9' ? c - '0' : (c | 32) - 'a' + 10;
    for (int bit = 3; bit >= 0; --bit) bits.push_back((digit >> bit & 1) != 0 ? '1' : '0');
  }
  const auto n = static_cast<std::size_t>(width);
  if (bits.size() < n) bits.insert(0, n - bits.size(), '0');
  return bits.substr(bits.size() - n);
}

}  // namespace cde::netlist
