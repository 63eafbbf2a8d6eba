// SPDX-License-Identifier: Apache-2.0
#include "cde/netlist/elaborate.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <utility>

#include "cde/contract/formats.hpp"
#include "cde/netlist/json_tree.hpp"
#include "cde/support/error.hpp"
#include "cde/support/process.hpp"
#include "cde/support/scratch.hpp"

extern char** environ;

namespace cde::netlist {
namespace {

constexpr unsigned kMostSeconds = 120;  ///< of processor time, where memory is limited

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Copies the hidden modules of a folder without their bodies. Verilator finds the copies first. It
/// would link all branches of every body before it knows which branches it needs.
void write_heads(const fs::path& from, const fs::path& to, const std::string& top,
                 const Hidden& hidden) {
  for (const auto& entry : fs::directory_iterator(from)) {
    const fs::path& file = entry.path();
    if (file.extension() != ".sv" || file.stem() == top || !hidden(file.stem().native())) continue;
    const std::string text = text_of(file);
    const std::size_t end = text.find("\n);\n");
    if (end != std::string::npos)
      std::ofstream(to / file.filename()) << text.substr(0, end) << "\n);\nendmodule\n";
  }
}

/// The switch for a parameter: text values in quotes, numbers as they are.
std::string parameter_switch(const std::string& parameter) {
  const std::size_t equals = parameter.find('=');
  const std::string value =
      equals == std::string::npos ? std::string() : parameter.substr(equals + 1);
  const bool number =
      !value.empty() && (value.find("'h") != std::string::npos ||
                         value.find_first_not_of("0123456789") == std::string::npos);
  std::string text("-G");
  text.append(parameter, 0, equals).append(number ? "=" : "=\"").append(value);
  return number ? text : text.append("\"");
}

/// A parameter's value as unsigned; nothing if it has unknown bits or is not a number.
std::optional<unsigned> constant_value(const Element& element) {
  const std::string bits = constant_bits(element);
  if (bits.empty() || bits.find_first_not_of("01") != std::string::npos) return std::nullopt;
  std::uint64_t value = 0;
  for (const char c : bits) value = value << 1 | (c == '1' ? 1u : 0u);
  return static_cast<unsigned>(value);
}

/// The name of an instance after the names of its generate blocks. A loop is a block with the
/// loop's name, which contains a block with the name and the iteration's number.
std::string scoped(const std::vector<std::string>& blocks, std::string_view name) {
  std::string all;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool loop = i + 1 < blocks.size() && blocks[i + 1].starts_with(blocks[i] + "[");
    if (!loop && !blocks[i].empty()) all.append(blocks[i]).append(".");
  }
  return all.append(name);
}

bool is_within(const std::string& path, const std::string& instance) {
  return path.starts_with(instance) &&
         (path.size() == instance.size() || path[instance.size()] == '.');
}

/// Verilator ends a file name at a space, so a name with a space is read through a link.
fs::path without_space(const fs::path& path, const fs::path& link) {
  if (path.native().find(' ') == std::string::npos) return path;
  fs::create_symlink(fs::absolute(path), link);
  return link;
}

/// Replaces file names below the link by the original names.
std::string named(std::string text, const fs::path& link, const fs::path& source) {
  if (link == source) return text;
  const std::string from = link.string() + "/", to = source.string() + "/";
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at))
    text.replace(at, from.size(), to), at += to.size();
  return text;
}

}  // namespace

bool is_gates(std::string_view module) {
  return module == "fp_gates";
}

std::string latency_parameter(unsigned add, unsigned mul, unsigned div, unsigned sqrt,
                              unsigned cmp) {
  return fmt::format("LAT=160'h{:08x}{:08x}{:08x}{:08x}{:08x}", add, mul, div, sqrt, cmp);
}

std::string elaborated(const fs::path& source, const std::string& top,
                       const std::vector<std::string>& parameters, const Hidden& hidden,
                       const std::vector<std::string>& switches, std::uint64_t most_memory) {
  const Scratch scratch("cde-elaborate");
  const fs::path rtl = without_space(source, scratch / "rtl");
  const fs::path xml = scratch / "design.xml", json = scratch / "design.tree.json",
                 meta = scratch / "design.tree.meta.json";
  std::vector<std::string> command = {"-Wno-fatal", "-Werror-USERERROR", "-Werror-USERFATAL",
                                      "-Mdir",      xml.parent_path(),   "--top-module",
                                      top};
  command.insert(command.end(), switches.begin(), switches.end());
  for (const std::string& parameter : parameters) command.push_back(parameter_switch(parameter));
  command.push_back(
      without_space(source.parent_path() / "verilator/waivers.vlt", scratch / "waivers.vlt"));
  std::ifstream packages(rtl / "contract/packages.f");
  for (std::string package; std::getline(packages, package);)
    command.push_back(rtl / "contract" / package);
  command.insert(command.end(), {"-y", xml.parent_path()});
  std::vector<fs::path> folders = {rtl};
  std::error_code missing;  // Verilator reports missing files
  for (const auto& entry : fs::directory_iterator(rtl, missing))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    if (hidden) write_heads(folder, xml.parent_path(), top, hidden);
    command.insert(command.end(), {"-y", folder.string(), "-I" + folder.string()});
  }
  command.push_back(top + ".sv");
  // Newer versions have one option, older ones the other, and some have both.
  std::string log;
  const auto written = [&](std::initializer_list<std::string> form) {
    std::vector<std::string> all = {"verilator"};
    if (most_memory != 0)
      all.insert(all.begin(), {"prlimit", fmt::format("--as={}", most_memory),
                               fmt::format("--data={}", most_memory),
                               fmt::format("--cpu={}", kMostSeconds), "--core=0", "--"});
    all.insert(all.end(), form);
    all.insert(all.end(), command.begin(), command.end());
    try {
      const process::Result ran = process::run(all);
      log = ran.output;
      return ran.status == 0;
    } catch (const Error& e) {
      throw ElaborationError(e.what());
    }
  };
  if (written({"--xml-only", "--xml-output", xml})) return named(text_of(xml), rtl, source);
  if (log.find("Invalid option: --xml-only") != std::string::npos) {
    if (written({"--json-only", "--json-only-output", json, "--json-only-meta-output", meta}))
      return xml_of_json(text_of(json), named(text_of(meta), rtl, source));
  }
  const std::string limit = most_memory == 0 ? ""
                                             : fmt::format(" in {} MB of memory and {} s",
                                                           most_memory >> 20, kMostSeconds);
  throw ElaborationError("verilator cannot elaborate " + top + limit + ":\n" + log);
}

Elaboration::Elaboration(const fs::path& rtl, const std::string& top,
                         const std::vector<std::string>& parameters, const Hidden& hidden) {
  try {
    netlist_.emplace(elaborated(rtl, top, parameters, hidden));
  } catch (const NetlistError& e) {
    throw ElaborationError("verilator's description of " + top + " cannot be read: " + e.what());
  }
  for (const Element* cell : netlist_->cells().children()) read_cells(*cell);
  for (const Element* e : netlist_->netlist().children()) {
    if (e->tag() != "module") continue;
    Module& module = modules_[e->text("name")];
    module.source_name = e->text("origName");
    std::vector<std::string> blocks;
    for (const Element* child : e->children()) read_body(*child, module, blocks);
  }
}

void Elaboration::read_cells(const Element& cell) {
  instances_.push_back({cell.text("hier"), cell.text("submodname")});
  by_path_.emplace(instances_.back().path, instances_.size() - 1);
  for (const Element* child : cell.children()) read_cells(*child);
}

void Elaboration::read_body(const Element& e, Module& module, std::vector<std::string>& blocks) {
  const std::string_view tag = e.tag();
  if (tag == "instance") {
    module.parts[scoped(blocks, e.text("name"))] = {e.text("defName"), netlist_->line(e)};
  } else if (tag == "var" && e.attribute("param").empty() && e.attribute("localparam").empty()) {
    module.types.emplace(e.text("name"), e.number("dtype_id"));
  } else if (tag == "var" && e.child(0) != nullptr) {
    if (const auto value = constant_value(*e.child(0)))
      module.constants.emplace(e.text("name"), *value);
  } else if (tag == "and") {
    ++module.ands;
  }
  if (tag == "begin") blocks.push_back(e.text("name"));
  for (const Element* child : e.children()) read_body(*child, module, blocks);
  if (tag == "begin") blocks.pop_back();
}

const Elaboration::Module* Elaboration::find(const std::string& instance) const {
  const auto at = by_path_.find(instance);
  if (at == by_path_.end()) return nullptr;
  const auto module = modules_.find(instances_[at->second].module);
  return module == modules_.end() ? nullptr : &module->second;
}

Operators Elaboration::operators(const std::string& instance) const {
  Operators count;
  for (const auto& [path, name] : instances_) {
    const auto found = modules_.find(name);
    if (!is_within(path, instance) || found == modules_.end()) continue;
    const Module& module = found->second;
    const std::string& what = module.source_name;
    // Every operator is an fp_lanes with some OP, alone or inside fp_add, fp_mul and similar
    // modules.
    if (what == "fp_lanes") {
      const auto at = module.constants.find("OP");
      switch (static_cast<FpOp>(at == module.constants.end() ? 0 : at->second)) {
        case FpOp::kAdd:
          ++count.adders;
          break;
        case FpOp::kSub:
          ++count.subtractors;
          break;
        case FpOp::kMul:
          ++count.multipliers;
          break;
        case FpOp::kDiv:
          ++count.dividers;
          break;
        case FpOp::kSqrt:
          ++count.square_roots;
          break;
        case FpOp::kLt:
        case FpOp::kLe:
        case FpOp::kEq:
          ++count.comparators;
          break;
        default:
          ++count.min_max;
          break;
      }
    }
    if (path == instance || what == "df_wire") count.mask_ands += module.ands;
  }
  return count;
}

std::vector<Place> Elaboration::places(const std::string& path) const {
  std::vector<Place> places;
  if (instances_.empty()) return places;
  auto module = modules_.find(instances_[0].module);
  std::string scopes;  // generate blocks since the last instance
  for (std::size_t at = std::min(path.find('.'), path.size() - 1) + 1; at < path.size();) {
    const std::size_t stop = std::min(path.find('.', at), path.size());
    scopes.append(scopes.empty() ? "" : ".").append(path, at, stop - at);
    at = stop + 1;
    if (module == modules_.end()) break;
    const auto part = module->second.parts.find(scopes);
    if (part == module->second.parts.end()) continue;  // a generate block
    const auto& [name, line] = part->second;
    module = modules_.find(name);
    Place place{.instance = std::exchange(scopes, {}), .module = {}, .file = {}};
    if (module != modules_.end()) place.module = module->second.source_name;
    place.file = fs::path(line.file).filename();
    place.line = line.line;
    places.push_back(std::move(place));
  }
  return places;
}

std::string Elaboration::module_of(const std::string& instance) const {
  const Module* module = find(instance);
  return module == nullptr ? std::string() : module->source_name;
}

std::optional<unsigned> Elaboration::constant(const std::string& instance,
                                              const std::string& name) const {
  const Module* module = find(instance);
  if (module == nullptr) return std::nullopt;
  const auto at = module->constants.find(name);
  return at == module->constants.end() ? std::nullopt : std::optional(at->second);
}

std::optional<unsigned> Elaboration::bits(const std::string& instance,
                                          const std::string& signal) const {
  const Module* module = find(instance);
  if (module == nullptr) return std::nullopt;
  const auto type = module->types.find(signal);
  if (type == module->types.end()) return std::nullopt;
  const std::uint64_t width = netlist_->type(type->second).width;
  return width == 0 ? std::nullopt : std::optional(static_cast<unsigned>(width));
}

}  // namespace cde::netlist
