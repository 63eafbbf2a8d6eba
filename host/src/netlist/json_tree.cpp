// SPDX-License-Identifier: Apache-2.0
#include "cde/netlist/json_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "cde/netlist/netlist.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/text_map.hpp"
#include "cde/support/xml_text.hpp"

namespace cde::netlist {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kMostNodeDepth = 2000;  // of nested nodes

/// Tags that differ from the node's name in small letters.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kTags = {
    {{"ASSIGNW", "contassign"}, {"GENBLOCK", "begin"}, {"CELL", "instance"}, {"PIN", "port"}}};

/// Lists of a node that are not children of the element.
constexpr std::array<std::string_view, 6> kLeftOut = {"childDTypep", "attrsp", "genforp",
                                                      "inlinesp",    "delayp", "timingControlp"};

/// Widths of types that are declared by name alone.
constexpr std::array<std::pair<std::string_view, int>, 5> kWidths = {
    {{"byte", 8}, {"shortint", 16}, {"int", 32}, {"integer", 32}, {"longint", 64}}};

class Writer {
 public:
  Writer(const Json& tree, const Json& meta) : tree_(tree) {
    if (text(tree, "type") != "NETLIST" || !tree.contains("modulesp") || !meta.contains("files"))
      throw NetlistError("it is not what verilator --json-only writes");
    note(tree, 0);
    out_ = "<verilator_xml><files>";
    for (const auto& [id, file] : meta.at("files").items())
      out_ += fmt::format("<file id=\"{}\" filename=\"{}\"/>", xml_text(id),
                          xml_text(text(file, "filename")));
    out_ += "</files><cells>";
    const Json* top = nullptr;
    for (const Json& module : tree.at("modulesp"))
      if (top == nullptr && text(module, "type") == "MODULE" && module.value("level", 0) == 1)
        top = &module;
    if (top == nullptr) throw NetlistError("it has no top module");
    cell(*top, text(*top, "name"), text(*top, "name"), text(*top, "loc"), 0);
    out_ += "</cells><netlist>";
    for (const Json& module : tree.at("modulesp")) write(module, &module == top);
    for (const Json& other : tree.value("miscsp", Json::array()))
      if (text(other, "type") == "TYPETABLE") write(other, false);
    out_ += "</netlist></verilator_xml>";
  }
  std::string take() { return std::move(out_); }

 private:
  static std::string text(const Json& node, const char* key) {
    const auto at = node.find(key);
    return at != node.end() && at->is_string() ? at->get<std::string>() : std::string();
  }
  [[nodiscard]] const Json* pointed(const Json& node, const char* key) const {
    const auto at = by_address_.find(text(node, key));
    return at == by_address_.end() ? nullptr : at->second;
  }
  static void each_child(const Json& node, const auto& visit) {
    for (const auto& [key, list] : node.items()) {
      if (!list.is_array() || std::find(kLeftOut.begin(), kLeftOut.end(), key) != kLeftOut.end())
        continue;
      for (const Json& child : list) visit(key, child);
    }
  }

  void note(const Json& node, unsigned depth) {
    if (depth > kMostNodeDepth) throw NetlistError("nodes are nested too deeply");
    if (!node.is_object()) throw NetlistError("a node is not an object");
    if (const std::string address = text(node, "addr"); !address.empty()) {
      by_address_.emplace(address, &node);
      ids_.emplace(address, static_cast<unsigned>(ids_.size()) + 1);
    }
    for (const auto& [key, list] : node.items())
      if (list.is_array())
        for (const Json& child : list) note(child, depth + 1);
  }

  /// Writes the instances below a module, without their generate blocks.
  void cell(const Json& module, const std::string& name, const std::string& path,
            const std::string& location, unsigned depth) {
    if (depth > kMostNodeDepth / 10 || out_.size() > (std::size_t{1} << 30))
      throw NetlistError("instances are too many or nested too deeply");
    out_ +=
        fmt::format("<cell loc=\"{}\" name=\"{}\" submodname=\"{}\" hier=\"{}\">", place(location),
                    xml_text(name), xml_text(text(module, "name")), xml_text(path));
    cells_in(module, path, depth);
    out_ += "</cell>";
  }
  void cells_in(const Json& node, const std::string& path, unsigned depth) {
    each_child(node, [&](const std::string&, const Json& child) {
      const std::string type = text(child, "type");
      if (type == "CELL") {
        const std::string name = text(child, "name");
        if (const Json* module = pointed(child, "modp"))
          cell(*module, name, path + "." + name, text(child, "loc"), depth + 1);
      } else if (type == "GENBLOCK" || type == "BEGIN") {
        cells_in(child, path, depth);
      }
    });
  }

  /// Converts c,12:7,12:19 to c,12,7,12,19.
  static std::string place(std::string location) {
    std::replace(location.begin(), location.end(), ':', ',');
    return xml_text(location);
  }
  static std::string tag_of(const std::string& type) {
    for (const auto& [node, tag] : kTags)
      if (type == node) return std::string(tag);
    std::string tag = type;
    for (char& c : tag) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c | 32 : c);
    return tag;
  }

  void add(std::string_view name, std::string_view value) {
    out_ += fmt::format(" {}=\"{}\"", name, xml_text(value));
  }
  void add_type(const Json& node, std::string_view name, const char* key) {
    const auto id = ids_.find(text(node, key));
    if (id != ids_.end()) add(name, fmt::to_string(id->second));
  }

  void write(const Json& node, bool top) {
    const std::string type = text(node, "type");
    if (type == "ALWAYS" && text(node, "keyword") == "cont_assign") {
      write_children(node);
    } else if (type == "VAR" && text(node, "varType") == "GENVAR") {
      // replaced by the iteration numbers of its loop
    } else if (type == "LOOP") {
      write_loop(node);
    } else {
      const std::string tag = tag_of(type);
      out_ += "<" + tag;
      write_attributes(node, type, top);
      out_ += ">";
      if (type == "IF")
        write_branches(node);
      else
        write_children(node);
      if (type == "SEL") constant(node.value("widthConst", 0u));
      out_ += "</" + tag + ">";
    }
  }
  void write_children(const Json& node) {
    each_child(node, [&](const std::string&, const Json& child) { write(child, false); });
  }
  void constant(unsigned value) { out_ += fmt::format("<const name=\"32'h{:x}\"/>", value); }

  void write_attributes(const Json& node, const std::string& type, bool top) {
    out_ += " loc=\"" + place(text(node, "loc")) + "\"";
    for (const char* name : {"name", "origName", "dotted", "edgeType", "kwd"})
      if (const std::string value = text(node, name); !value.empty()) add(name, value);
    if (top) add("topModule", "1");
    if (type.ends_with("DTYPE")) {
      add_type(node, "id", "addr");
      add_type(node, "sub_dtype_id", "refDTypep");
      if (type == "BASICDTYPE") add_range(node);
      return;
    }
    add_type(node, "dtype_id", "dtypep");
    if (type == "VAR") {
      const std::string direction = text(node, "direction"), kind = text(node, "varType");
      add("vartype", text(node, "dtypeName"));
      if (direction != "NONE") add("dir", small(direction));
      if (kind == "GPARAM") add("param", "true");
      if (kind == "LPARAM") add("localparam", "true");
    } else if (type == "CELL") {
      if (const Json* module = pointed(node, "modp")) add("defName", text(*module, "name"));
    } else if (type == "PIN") {
      const Json* port = pointed(node, "modVarp");
      const std::string direction = port == nullptr ? "" : text(*port, "direction");
      add("direction", direction == "OUTPUT" ? "out" : direction == "INPUT" ? "in" : "inout");
    }
  }
  static std::string small(std::string text) {
    for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c | 32 : c);
    return text;
  }
  void add_range(const Json& node) {
    const std::string range = text(node, "range"), keyword = text(node, "keyword");
    if (const std::size_t colon = range.find(':'); colon != std::string::npos) {
      add("left", range.substr(0, colon));
      add("right", range.substr(colon + 1));
      return;
    }
    for (const auto& [name, width] : kWidths)
      if (keyword == name) {
        add("left", fmt::to_string(width - 1));
        add("right", "0");
      }
  }

  /// Writes the condition, the branch if it holds and the branch if not, each in a block.
  void write_branches(const Json& node) {
    for (const char* key : {"condp", "thensp", "elsesp"}) {
      const auto list = node.find(key);
      if (list == node.end() || !list->is_array()) continue;
      const bool block = std::string_view(key) != "condp";
      if (block && list->empty() && std::string_view(key) == "elsesp") continue;
      if (block) out_ += "<begin>";
      for (const Json& child : *list) write(child, false);
      if (block) out_ += "</begin>";
    }
  }

  /// Writes a loop as while: an empty block, its condition, its body and its step, each in a block.
  void write_loop(const Json& node) {
    const Json statements = node.value("stmtsp", Json::array());
    const bool tested = !statements.empty() && text(statements.front(), "type") == "LOOPTEST";
    const std::size_t body = tested ? 1 : 0;
    std::size_t step = statements.size();
    if (tested && step > 1 && text(statements[step - 1], "type") == "ASSIGN") --step;
    out_ += "<while loc=\"" + place(text(node, "loc")) + "\"><begin></begin><begin>";
    if (tested) write_children(statements.front());
    out_ += "</begin><begin>";
    for (std::size_t i = body; i < step; ++i) write(statements[i], false);
    out_ += "</begin><begin>";
    for (std::size_t i = step; i < statements.size(); ++i) write(statements[i], false);
    out_ += "</begin></while>";
  }

  const Json& tree_;
  TextMap<const Json*> by_address_;
  TextMap<unsigned> ids_;
  std::string out_;
};

Json parsed(const std::string& text, const char* what) {
  if (nested_deeper(text, 2 * kMostNodeDepth)) throw NetlistError("nodes are nested too deeply");
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw NetlistError(fmt::format("{} is not JSON, or truncated", what));
  return json;
}

}  // namespace

std::string xml_of_json(const std::string& tree, const std::string& meta) {
  try {
    const Json nodes = parsed(tree, "the tree"), names = parsed(meta, "its .meta.json");
    return Writer(nodes, names).take();
  } catch (const Json::exception& e) {
    throw NetlistError(fmt::format("it is not what verilator --json-only writes: {}", e.what()));
  }
}

}  // namespace cde::netlist
