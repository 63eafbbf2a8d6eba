// SPDX-License-Identifier: Apache-2.0
// Finds the design of the waves: from a named file, or from the comment in a card's waves, by
// Verilator or from the cache.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <sstream>

#include "cde/model/cache_entry.hpp"
#include "cde/model/model.hpp"
#include "cde/netlist/elaborate.hpp"
#include "cde/netlist/json_tree.hpp"
#include "cde/support/error.hpp"
#include "cde/support/input_file.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/elaborated.hpp"
#include "support/file_io.hpp"

namespace cde::wave {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHead = "cde structure 2\n";
/// Bytes that Verilator may take. The parameters come from a wave file, perhaps of a stranger.
constexpr std::uint64_t kMostMemory = std::uint64_t{4} << 30;

/// The comment that the writer of a card's waves adds (verilator/models/wave_file.h).
struct Origin {
  std::string kind, hash;
  std::vector<std::string> parameters;

  [[nodiscard]] std::string text() const {
    return fmt::format("{} {}", kind, fmt::join(parameters, " "));
  }
};

constexpr std::string_view kLower = "abcdefghijklmnopqrstuvwxyz",
                           kUpper = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", kDigits = "0123456789";

/// Whether the word is not empty and has only characters of these sets.
bool consists_of(std::string_view word, std::initializer_list<std::string_view> sets) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [&](char c) {
    return std::any_of(sets.begin(), sets.end(),
                       [&](std::string_view set) { return set.find(c) != std::string_view::npos; });
  });
}

/// "board", "pair_unit"
bool is_kind(std::string_view word) {
  return consists_of(word.substr(0, 1), {kLower}) && consists_of(word, {kLower, kDigits, "_"});
}

/// "LANES=4"
bool is_parameter(std::string_view word) {
  const std::size_t equals = std::min(word.find('='), word.size());
  return consists_of(word.substr(0, 1), {kUpper}) &&
         consists_of(word.substr(0, equals), {kUpper, kDigits, "_"}) &&
         consists_of(word.substr(std::min(equals + 1, word.size())),
                     {kUpper, kLower, kDigits, "_"});
}

/// The digits of "configuration=0123456789abcdef"; empty for another word.
std::string_view configuration_of(std::string_view word) {
  constexpr std::string_view kKey = "configuration=";
  const std::string_view hash = word.starts_with(kKey) ? word.substr(kKey.size()) : "";
  return hash.size() == 16 && consists_of(hash, {kDigits, "abcdef"}) ? hash : "";
}

std::optional<Origin> origin_of(Trace& trace) {
  constexpr std::size_t kLongest = 4096;  // the words go to the builder's command line
  for (const std::string& comment : trace.comments()) {
    if (comment.size() > kLongest) continue;
    std::istringstream words(comment);
    std::string word;
    Origin origin;
    if (!(words >> word) || word != "model" || !(words >> origin.kind) || !is_kind(origin.kind))
      continue;
    bool good = true;
    while (words >> word) {
      if (const std::string_view hash = configuration_of(word); !hash.empty())
        origin.hash = hash;
      else if (is_parameter(word))
        origin.parameters.push_back(word);
      else
        good = false;
    }
    if (good && !origin.hash.empty()) return origin;
  }
  return std::nullopt;
}

/// The named design in the format of --xml-only.
struct NamedStructure {
  std::string xml;
  std::optional<uid_t> stranger = {};  ///< as Elaborated::stranger

  void note_owner(uid_t owner) {
    if (owner != 0 && owner != ::geteuid()) stranger = owner;
  }
};

NamedStructure named_structure(const std::string& file) {
  constexpr std::string_view kJson = ".json";
  constexpr std::uint64_t kMostMeta = 64u << 20;
  NamedStructure named;
  uid_t owner = 0;
  named.xml = read_file(file, &owner);
  named.note_owner(owner);
  if (!file.ends_with(kJson)) return named;
  const std::string meta = file.substr(0, file.size() - kJson.size()) + ".meta.json";
  const std::string files = file_io::read_regular(meta, kMostMeta, &owner);
  named.note_owner(owner);
  try {
    named.xml = netlist::xml_of_json(named.xml, files);
    return named;
  } catch (const netlist::NetlistError& e) {
    throw Error(ErrorCode::kFile, fmt::format("{}: not a structure file: {}", printable_name(file),
                                              printable(e.what())));
  }
}

/// Sources and XML in one cache entry, so that the shown lines are the elaborated ones.
struct Kept {
  std::map<std::string, std::string> sources;
  std::string xml;

  [[nodiscard]] std::string text() const {
    std::string all(kHead);
    for (const auto& [name, source] : sources)
      all += fmt::format("{} {}\n{}", source.size(), name, source);
    return all + "\n" + xml;
  }
  [[nodiscard]] static std::optional<Kept> of(const std::string& text) {
    if (!text.starts_with(kHead)) return std::nullopt;
    Kept kept;
    std::size_t at = kHead.size();
    for (;;) {
      const std::size_t stop = text.find('\n', at);
      if (stop == std::string::npos) return std::nullopt;
      if (stop == at) break;
      std::size_t bytes = 0;
      const auto read = std::from_chars(text.data() + at, text.data() + stop, bytes);
      if (read.ec != std::errc() || *read.ptr != ' ' || bytes > text.size() - stop - 1)
        return std::nullopt;
      const auto name = static_cast<std::size_t>(read.ptr - text.data()) + 1;
      kept.sources[text.substr(name, stop - name)] = text.substr(stop + 1, bytes);
      at = stop + 1 + bytes;
    }
    kept.xml = text.substr(at + 1);
    return kept;
  }
  /// Error kFile if the XML is none of Verilator.
  [[nodiscard]] Design design(const std::string& what) const {
    Design design(xml, what);
    for (const auto& [file, source] : sources) design.set_source(file, source);
    return design;
  }
};

/// The design in a cache entry; nothing if the entry holds none, so that it is made again.
std::optional<Design> cached_design(const std::string& name, const std::string& what) {
  const auto text = read_cache_entry(name);
  const auto kept = text ? Kept::of(*text) : std::nullopt;
  if (!kept) return std::nullopt;
  try {
    return kept->design(what);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The elaborated design of a simulation model. Nothing if it is not cached and `elaborate` is
/// false.
std::optional<Design> design_of(const Origin& origin, const std::string& waves, bool elaborate) {
  const std::string name =
      cache_key({std::string(kHead), origin.text(), origin.hash}) + ".structure";
  const std::string what = "simulation model " + origin.text();
  std::optional<Design> cached = cached_design(name, what);
  if (cached || !elaborate) return cached;
  const std::uint64_t here = model_hash(origin.kind, origin.parameters);
  if (fmt::format("{:016x}", here) != origin.hash)
    throw Error(ErrorCode::kUsage,
                fmt::format("{} comes from {} with other RTL (configuration {}; here {:016x}); "
                            "write the waves again, or name their structure with --structure",
                            printable_name(waves), what, origin.hash, here));
  const fs::path rtl = model_builder().parent_path().parent_path() / "rtl";
  std::vector<std::string> parameters = origin.parameters;
  std::erase_if(parameters, [](const std::string& p) {
    return p.starts_with("TRACE=") || p.starts_with("TAP=");
  });
  const bool host =
      std::find(parameters.begin(), parameters.end(), "ARITH=host") != parameters.end();
  log(fmt::format("cde: reading the structure of {} (kept for the next time)\n", what));
  Kept kept;
  try {
    kept.xml = netlist::elaborated(rtl, origin.kind, parameters,
                                   host ? netlist::Hidden(netlist::is_gates) : netlist::Hidden(),
                                   {"-O0"},  // optimisation would remove signals of the sources
                                   kMostMemory);
  } catch (const netlist::ElaborationError& e) {
    throw Error(ErrorCode::kBuild, e.what());
  }
  for (const std::string& file : Design(kept.xml, what).files())
    if (fs::is_regular_file(file)) kept.sources[file] = read_named_file(file);
  write_cache_entry(name, kept.text());
  return kept.design(what);
}

/// A top module's parameter as text; empty if it does not exist or is neither a number nor a
/// string.
std::string parameter_of(const Design::Elaborated& all, const std::string& name) {
  const Body& top = all.body(0);
  const auto v = top.by_path.find(name);
  if (v == top.by_path.end()) return {};
  const netlist::Element* const value = top.variables[v->second].declared->child(0);
  if (value == nullptr) return {};
  const std::string text = value->text("name");
  if (text.size() >= 2 && text.front() == '"') return text.substr(1, text.size() - 2);
  const std::string bits = netlist::constant_bits(*value);
  if (bits.size() > 64 || bits.empty()) return {};
  std::uint64_t number = 0;
  for (const char c : bits) number = number << 1 | (c == '1' ? 1u : 0u);
  return fmt::to_string(number);
}

/// The text that the bytes of a number make: Verilator writes strings this way.
std::string as_text(const std::string& number) {
  std::uint64_t value = 0;
  std::from_chars(number.data(), number.data() + number.size(), value);
  std::string text;
  for (; value != 0; value >>= 8) text.insert(text.begin(), static_cast<char>(value & 0xff));
  return text;
}

/// Error kUsage if the named design belongs to another simulation model than the waves.
void check_origin(const Design::Elaborated& all, const Origin& origin, const std::string& waves) {
  const auto differ = [&](const std::string& of_waves, const std::string& of_structure) {
    throw Error(
        ErrorCode::kUsage,
        fmt::format(
            "{} comes from simulation model {}, but {} describes another design: {} there, {} here",
            printable_name(waves), origin.text(), printable_name(all.file), of_waves,
            printable(of_structure)));
  };
  if (all.body(0).source_name != origin.kind) differ(origin.kind, all.body(0).source_name);
  for (const std::string& p : origin.parameters) {
    const std::size_t equals = p.find('=');
    const std::string name = p.substr(0, equals), own = parameter_of(all, name);
    const std::string wanted = p.substr(equals + 1);
    if (!own.empty() && own != wanted && as_text(own) != wanted)
      differ(p, fmt::format("{}={}", name, own));
  }
}

}  // namespace

std::vector<std::string> Design::files() const {
  std::vector<std::string> all;
  for (const auto& [letters, name] : all_->netlist.files()) all.push_back(name);
  return all;
}

void Design::set_source(const std::string& file, const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  all_->sources[file] = std::move(lines);
}

/// Chooses the scope with the most variables and instances of the top module; the outermost of
/// equals.
void Design::choose_prefix(Trace& trace) {
  std::map<std::string_view, std::size_t> score;
  std::vector<std::string_view> order;
  const Body& top = all_->body(0);
  std::set<std::string_view> scopes;
  for (const Signal& s : trace.signals()) {
    const std::string_view name = s.name;
    for (std::size_t dot = name.find('.'); dot != std::string_view::npos;
         dot = name.find('.', dot + 1)) {
      const std::string_view scope = name.substr(0, dot);
      std::string_view own = name.substr(dot + 1);
      own = own.substr(0, own.find_first_of(".["));
      const auto [at, fresh] = score.try_emplace(scope, 0);
      if (fresh) order.push_back(scope);
      if (name.find('.', dot + 1) == std::string_view::npos && top.by_path.contains(own))
        ++at->second;
      scopes.insert(scope);
    }
  }
  const auto part_in = [&](std::string_view scope, const std::string& part) {
    return scopes.contains(fmt::format("{}.{}", scope, part));
  };
  std::string_view best;
  std::size_t most = 0;
  for (const std::string_view scope : order) {
    std::size_t points = score[scope];
    for (const Part& p : top.parts)
      if (part_in(scope, p.path)) points += 1000;
    if (points > most) {
      most = points;
      best = scope;
    }
  }
  // All simulators write the ports of a module that they trace.
  const auto ports = static_cast<std::size_t>(
      std::count_if(top.variables.begin(), top.variables.end(),
                    [](const Variable& v) { return !v.declared->attribute("pinIndex").empty(); }));
  if (most == 0 || score[best] * 2 < std::min<std::size_t>(ports, top.variables.size()))
    throw Error(ErrorCode::kUsage,
                fmt::format("{} is not the structure of {}: no scope there has the signals of {}",
                            printable_name(all_->file), printable_name(trace.file().string()),
                            printable_name(top.source_name)));
  all_->prefix = best;
}

Design Design::of(Trace& trace, const std::string& structure) {
  const std::string waves = trace.file().string();
  const auto origin = origin_of(trace);
  if (structure.empty()) {
    if (!origin)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} does not name its design; name its structure with --structure "
                              "FILE, which `verilator -O0 --xml-only` or --json-only writes",
                              printable_name(waves)));
    std::optional<Design> design = design_of(*origin, waves, true);
    design->choose_prefix(trace);
    return std::move(*design);
  }
  NamedStructure named = named_structure(structure);
  Design design(std::move(named.xml), structure);
  design.all_->stranger = named.stranger;
  if (origin) check_origin(*design.all_, *origin, waves);
  design.choose_prefix(trace);
  return design;
}

Design Design::of_model(const std::string& kind, const std::vector<std::string>& parameters) {
  const Origin origin{kind, fmt::format("{:016x}", model_hash(kind, parameters)), parameters};
  std::optional<Design> design = design_of(origin, "", true);
  return std::move(*design);
}

std::optional<Design> Design::if_known(Trace& trace, const std::string& structure) {
  if (!structure.empty()) return of(trace, structure);
  const auto origin = origin_of(trace);
  if (!origin) return std::nullopt;
  std::optional<Design> design = design_of(*origin, trace.file().string(), false);
  if (design) design->choose_prefix(trace);
  return design;
}

}  // namespace cde::wave
