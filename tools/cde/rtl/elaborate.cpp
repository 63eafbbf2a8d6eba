// SPDX-License-Identifier: Apache-2.0
#include "rtl/elaborate.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include "cde/contract/formats.hpp"

extern char** environ;

namespace cde::rtl {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for Verilator's files, removed at the end.
class Scratch {
 public:
  Scratch() : path_((fs::temp_directory_path() / "cde-elaborate-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr)
      throw ElaborationError(path_ + ": cannot create: " + std::generic_category().message(errno));
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] fs::path operator/(const char* name) const { return fs::path(path_) / name; }

 private:
  std::string path_;
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A module without its body. Nobody looks below an operator, and Verilator links all branches of
/// each before it knows which it needs (obb-obb with gates: 34 s with their bodies, 5 without).
void write_head_of(const fs::path& module, const fs::path& to) {
  const std::string text = text_of(module);
  const std::size_t end = text.find("\n);\n");
  if (end == std::string::npos) return;
  std::ofstream(to) << text.substr(0, end) << "\n);\nendmodule\n";
}

/// Exit status of a program that writes to `log`.
int run(const std::vector<std::string>& command, const fs::path& log) {
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0)
    throw ElaborationError("cannot run " + command[0] + ": " +
                           std::generic_category().message(failed));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Text values in quotes, numbers as they are.
std::string parameter_switch(const std::string& parameter) {
  const std::size_t equals = parameter.find('=');
  const std::string value =
      equals == std::string::npos ? std::string() : parameter.substr(equals + 1);
  const bool number = !value.empty() && value.find_first_not_of("0123456789") == std::string::npos;
  std::string text("-G");
  text.append(parameter, 0, equals).append(number ? "=" : "=\"").append(value);
  return number ? text : text.append("\"");
}

/// `name="VALUE"` of an element; empty if it has none.
std::string_view attribute(std::string_view element, std::string_view name) {
  std::string key(1, ' ');
  key.append(name).append("=\"");
  const std::size_t at = element.find(key);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = element.substr(at + key.size());
  return rest.substr(0, rest.find('"'));
}

unsigned decimal(std::string_view text) {
  return static_cast<unsigned>(std::strtoul(std::string(text).c_str(), nullptr, 10));
}

/// A constant as Verilator writes it, 32'sh1f.
std::optional<unsigned> constant_value(std::string_view element) {
  const std::string_view text = attribute(element, "name");
  constexpr std::string_view kQuote = "&apos;";
  const std::size_t quote = text.find(kQuote), base = text.find('h', quote);
  if (quote == std::string_view::npos || base == std::string_view::npos) return std::nullopt;
  const std::string digits(text.substr(base + 1));
  if (digits.empty() || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
    return std::nullopt;
  return static_cast<unsigned>(std::strtoull(digits.c_str(), nullptr, 16));
}

/// A packed array type: the type of its elements, and its range.
struct Packed {
  unsigned element = 0, low = 0, high = 0;
  bool has_low = false;
};

/// The name of an instance behind those of the generate blocks that it is in. A loop is a block of
/// its name, with one of its name and number in it.
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

}  // namespace

Elaboration::Elaboration(const fs::path& rtl, const std::string& top,
                         const std::vector<std::string>& parameters) {
  const Scratch scratch;
  const fs::path xml = scratch / "design.xml", log = scratch / "verilator.log";
  std::vector<std::string> command = {
      "verilator",         "--xml-only",   "-Wno-fatal", "-Werror-USERERROR",
      "-Werror-USERFATAL", "--xml-output", xml.string(), "-Mdir",
      xml.parent_path(),   "--top-module", top};
  for (const std::string& parameter : parameters) command.push_back(parameter_switch(parameter));
  command.push_back(rtl.parent_path() / "verilator/waivers.vlt");
  std::ifstream packages(rtl / "contract/packages.f");
  for (std::string package; std::getline(packages, package);)
    command.push_back(rtl / "contract" / package);
  write_head_of(rtl / "fp/fp_gates.sv", scratch / "fp_gates.sv");
  if (top != "fp_gates") command.insert(command.end(), {"-y", xml.parent_path()});
  std::vector<fs::path> folders = {rtl};
  std::error_code missing;  // Verilator names what it does not find
  for (const auto& entry : fs::directory_iterator(rtl, missing))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    command.insert(command.end(), {"-y", folder.string(), "-I" + folder.string()});
  }
  command.push_back(top + ".sv");
  if (run(command, log) != 0) {
    const std::string said = text_of(log);
    if (said.find("Invalid option: --xml-only") != std::string::npos)
      throw ElaborationError(
          "this version of verilator has no --xml-only, from whose output operators are counted: "
          "put an older one, such as 5.006 or 5.032, on PATH");
    throw ElaborationError("verilator cannot elaborate " + top + ":\n" + said);
  }
  read(text_of(xml));
}

// Verilator writes one element a line; nothing else is assumed of the layout.
void Elaboration::read(const std::string& xml) {
  Module* module = nullptr;
  std::string parameter;              // whose value comes next
  std::map<unsigned, Packed> packed;  // type -> element type and range
  unsigned open_type = 0;
  std::vector<std::string> blocks;  // that are open
  for (std::size_t at = 0; at < xml.size();) {
    const std::size_t stop = std::min(xml.find('\n', at), xml.size());
    std::string_view line(xml.data() + at, stop - at);
    at = stop + 1;
    line.remove_prefix(std::min(line.find('<'), line.size()));
    const std::string_view tag = line.substr(0, line.find_first_of(" >"));
    if (tag == "<cell") {
      instances_.push_back(
          {std::string(attribute(line, "hier")), std::string(attribute(line, "submodname"))});
      by_path_.emplace(instances_.back().path, instances_.size() - 1);
    } else if (tag == "<file") {
      files_.emplace(attribute(line, "id"), attribute(line, "filename"));
    } else if (tag == "<module") {
      module = &modules_[std::string(attribute(line, "name"))];
      module->source_name = attribute(line, "origName");
      blocks.clear();
    } else if (tag == "</module") {
      module = nullptr;
    } else if (tag == "<begin" && !line.ends_with("/>")) {
      blocks.emplace_back(attribute(line, "name"));
    } else if (tag == "</begin" && !blocks.empty()) {
      blocks.pop_back();
    } else if (tag == "<instance" && module != nullptr) {
      module->parts[scoped(blocks, attribute(line, "name"))] = {
          std::string(attribute(line, "defName")), std::string(attribute(line, "loc"))};
    } else if (tag == "<var" && module != nullptr) {
      const std::string name(attribute(line, "name"));
      const bool is_constant =
          !attribute(line, "param").empty() || !attribute(line, "localparam").empty();
      parameter = is_constant ? name : "";
      if (!is_constant) module->types.emplace(name, decimal(attribute(line, "dtype_id")));
    } else if (tag == "<const" && !parameter.empty() && module != nullptr) {
      if (const auto value = constant_value(line)) module->constants.emplace(parameter, *value);
    } else if (tag == "<and" && module != nullptr) {
      ++module->ands;
    } else if (tag == "<basicdtype") {
      const unsigned left = decimal(attribute(line, "left")),
                     right = decimal(attribute(line, "right"));
      widths_[decimal(attribute(line, "id"))] = (left > right ? left - right : right - left) + 1;
    } else if (tag == "<packarraydtype") {
      open_type = decimal(attribute(line, "id"));
      packed[open_type].element = decimal(attribute(line, "sub_dtype_id"));
    } else if (tag == "<const" && open_type != 0) {
      Packed& type = packed[open_type];
      (type.has_low ? type.low : type.high) = constant_value(line).value_or(0);
      type.has_low = true;
    } else if (tag == "</packarraydtype") {
      open_type = 0;
    }
    if (tag != "<var") parameter.clear();
  }
  // A type may stand before the type of its elements.
  for (bool found = true; found;) {
    found = false;
    for (const auto& [id, type] : packed) {
      const auto element = widths_.find(type.element);
      if (element == widths_.end()) continue;
      const unsigned width = element->second * (type.high - type.low + 1);
      found = widths_.emplace(id, width).second || found;
    }
  }
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
    // Every operator is an fp_lanes of some OP, alone or inside fp_add, fp_mul and their like.
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
    const auto& [name, location] = part->second;
    module = modules_.find(name);
    Place place{.instance = std::exchange(scopes, {}), .module = {}, .file = {}};
    if (module != modules_.end()) place.module = module->second.source_name;
    const std::size_t comma = std::min(location.find(','), location.size());
    const auto file = files_.find(location.substr(0, comma));
    if (file != files_.end()) place.file = fs::path(file->second).filename();
    if (comma < location.size()) place.line = decimal(std::string_view(location).substr(comma + 1));
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
  const auto width = widths_.find(type->second);
  return width == widths_.end() ? std::nullopt : std::optional(width->second);
}

}  // namespace cde::rtl
