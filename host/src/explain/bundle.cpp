// SPDX-License-Identifier: Apache-2.0
#include "cde/explain/bundle.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <set>
#include <system_error>

#include "cde/card/json_keys.hpp"
#include "cde/explain/explain_text.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/shell_word.hpp"
#include "cde/wave/design.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/nearby.hpp"
#include "cde/wave/request.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"
#include "support/unfinished.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr unsigned kMostFolders = 1000;
constexpr std::uint64_t kCauses = 400, kMostNodes = 3000;  // lines of why.txt; nodes to read
constexpr unsigned kDepth = 16;  // registers on a path, most of which only pass a word on
constexpr std::size_t kMostOperators = 3, kMostNear = 24;  // operators whose operands are followed
constexpr unsigned kSteps = 3;
constexpr std::size_t kMostPlaces = 6;
constexpr std::size_t kMostLines = 10, kMostCauses = 24;  // lines of fail.txt

/// FOLDER, or the first of FOLDER-2, FOLDER-3, ... that does not exist.
fs::path new_folder(const std::string& wanted, std::optional<OutputFolder>& made) {
  if (const auto why = why_no_new_folder(wanted))
    throw Error(ErrorCode::kUsage, fmt::format("{}: {}; expected the name of a new folder",
                                               printable_name(wanted), *why));
  std::string name = wanted;
  while (name.size() > 1 && name.ends_with('/')) name.pop_back();
  for (unsigned n = 1; n <= kMostFolders; ++n) {
    const fs::path folder = n == 1 ? name : fmt::format("{}-{}", name, n);
    if (fs::exists(fs::symlink_status(folder))) continue;
    made.emplace(folder);
    if (made->made()) return folder;
    made->keep();  // another process has just made it
  }
  throw Error(
      ErrorCode::kFile,
      fmt::format("{}: all {} folders of this name exist; remove some, since none is overwritten",
                  printable_name(wanted), kMostFolders));
}

/// Lines of the operators that differ first, with the number of operators per line.
std::string lines_of(const explain::Explanation& e) {
  std::vector<std::pair<std::string, unsigned>> lines;
  for (const explain::Finding& f : e.findings) {
    if (f.sources.empty()) continue;
    const std::string line = f.sources.front().line();
    const auto known =
        std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.first == line; });
    if (known != lines.end())
      ++known->second;
    else
      lines.emplace_back(line, 1);
  }
  if (lines.empty()) return "  operators without a match\n";
  std::string text;
  for (std::size_t i = 0; i < lines.size() && i < kMostLines; ++i)
    text += fmt::format("  {}. {}, {} operator{}\n", i + 1, lines[i].first, lines[i].second,
                        lines[i].second == 1 ? "" : "s");
  if (lines.size() > kMostLines) text += fmt::format("  {} more\n", lines.size() - kMostLines);
  return text;
}

/// Whether the file holds parts of a dataflow line or the surroundings of a pipe.
bool is_wiring(const std::string& file) {
  static const std::set<std::string> kAround = {"pipe_delay.sv",  "lane_select.sv", "fp_lanes.sv",
                                                "fp_host.sv",     "fp_delay.sv",    "fp_gates.sv",
                                                "fp_sign.sv",     "pair_pipe.sv",   "pair_unit.sv",
                                                "scaled_pipe.sv", "bounded_pipe.sv"};
  return file.starts_with("df_") || file.starts_with("vec_") || kAround.contains(file);
}

std::string name_of(const wave::Place& place) {
  return fs::path(place.file).filename().string();
}

/// The operator's cell in the design of a unit; empty if it has none.
std::string cell_of(const explain::Explanation& e, std::int32_t which) {
  const std::string& path = e.operators[static_cast<std::size_t>(which)].path;
  const std::size_t top = path.find("pair_unit.", 1);  // behind Verilator's own name
  return top == std::string::npos ? "" : path.substr(top, path.rfind('.') - top);
}

const explain::Step& step_of(const explain::Explanation& e, const explain::Compared& c) {
  return e.recording.steps[static_cast<std::size_t>(e.recording.operators[c.operation])];
}

/// Whether the file holds the operators of a pipe, below the parts of a dataflow line.
bool is_operator(const std::string& file) {
  return file == "fp_lanes.sv" || file == "fp_host.sv" || file == "fp_gates.sv";
}

/// Whether the file holds the check of operands. Both sides agree about it if they compare answers.
bool is_check(const std::string& file) {
  return file == "shape_check.sv";
}

/// Operand signals of a differing operator that may have arrived wrong: the operand that differs,
/// or both for an uncertain match.
std::vector<std::string> operands(const explain::Explanation& e, const explain::Compared& c) {
  std::vector<std::string> signals;
  const auto add = [&](std::int32_t which, const char* port) {
    if (const std::string cell = cell_of(e, which); !cell.empty()) signals.push_back(cell + port);
  };
  if (c.seat.which < 0) {
    for (const std::int32_t which : c.others)
      for (const char* port : {".a_i", ".b_i"}) add(which, port);
  } else if (c.comparison == explain::Comparison::kOperands) {
    const explain::Step& wanted = step_of(e, c);
    const auto is_wanted = [&](std::uint64_t word) { return word == wanted.a || word == wanted.b; };
    const bool neither = is_wanted(c.card.a) == is_wanted(c.card.b);
    if (neither || !is_wanted(c.card.a)) add(c.seat.which, ".a_i");
    if (neither || !is_wanted(c.card.b)) add(c.seat.which, ".b_i");
  }
  return signals;
}

/// The result signal of an operator with the right operation and operands, whose inside is then
/// wrong. Empty for other operators.
std::vector<std::string> results(const explain::Explanation& e, const explain::Compared& c) {
  if (c.seat.which < 0 || c.comparison != explain::Comparison::kResult) return {};
  const explain::Step& wanted = step_of(e, c);
  const std::string cell = cell_of(e, c.seat.which);
  if (cell.empty() || c.card.a != wanted.a || c.card.operation != wanted.operation) return {};
  return {cell + ".r_o"};
}

/// Lines a few statements upstream of the first wrong operators: between them and the correct
/// operators before them, or inside them.
Json near_lines(const explain::Explanation& e) {
  std::vector<std::string> before, inside;
  for (std::size_t i = 0; i < e.findings.size() && i < kMostOperators; ++i) {
    for (std::string& signal : operands(e, e.findings[i].compared))
      before.push_back(std::move(signal));
    for (std::string& signal : results(e, e.findings[i].compared))
      inside.push_back(std::move(signal));
  }
  if (before.empty() && inside.empty()) return Json::array();
  PairConfig plain = e.config;
  plain.tap = plain.trace = false;
  const wave::Design design = wave::Design::of_model("pair_unit", plain.parameters());
  Json lines = Json::array();
  const auto add = [&](const std::vector<std::string>& signals, const wave::Passing& passing) {
    for (const auto& [p, drivers] :
         wave::driving_statements(design, signals, kSteps, 4 * kMostNear, passing)) {
      const std::string file = name_of(p);
      if (is_wiring(file) || lines.size() == kMostNear) continue;
      lines.push_back(
          {{"file", file}, {"line", p.line}, {"drivers", drivers}, {"source_text", p.text}});
    }
  };
  add(before, {.wire = [](const wave::Place& p) { return is_wiring(name_of(p)); },
               .end = [](const wave::Place& p) { return is_operator(name_of(p)); }});
  add(inside, {});
  return lines;
}

/// Lines of a cone's statements, nearest to the root first. Statements that only pass a signal on
/// are no step, and neither are the parts of a dataflow line. Operators known to be right end the
/// cone.
Json lines_of(const Json& cone, bool operators) {
  struct Waiting {
    const Json* node;
    unsigned drivers;
  };
  Json lines = Json::array();
  std::set<std::pair<std::string, int>> seen;
  std::deque<Waiting> waiting = {{&cone, 1}};
  while (!waiting.empty()) {
    const Waiting now = waiting.front();
    waiting.pop_front();
    for (const Json& statement : (*now.node)["statements"]) {
      const std::string file =
          fs::path(statement["source_file"].get<std::string>()).filename().string();
      if (!operators && (is_operator(file) || is_check(file))) continue;
      const int line = statement["line"];
      const Json& causes = statement["causes"];
      const bool forwarded = statement["forwarded_cause"].is_number();
      const std::size_t same =
          forwarded ? statement["forwarded_cause"].get<std::size_t>() : causes.size();
      if (!file.empty() && seen.emplace(file, line).second)
        lines.push_back({{"file", file},
                         {"line", line},
                         {"drivers", now.drivers},
                         {"is_wire", forwarded || is_wiring(file)},
                         {"source_text", statement["source_text"]}});
      for (std::size_t i = 0; i < causes.size(); ++i)
        if (i == same || (!forwarded && is_wiring(file)))
          waiting.push_front({&causes[i], now.drivers});
        else
          waiting.push_back({&causes[i], now.drivers + 1});
    }
  }
  return lines;
}

/// Places to look at first, likeliest first. For a pipe that is wrong on its own: its first
/// differing operators and the lines that feed them. For the card, or if no operator differs: the
/// lines that made the signal wrong.
Json places_to_look_at(const Json& j) {
  Json places = Json::array();
  const auto add = [&](const Json& line, const char* reason) {
    const bool known = std::any_of(places.begin(), places.end(), [&](const Json& p) {
      return p["file"] == line["file"] && p["line"] == line["line"];
    });
    if (known || places.size() == kMostPlaces) return;
    Json place = {{"file", line["file"]}, {"line", line["line"]}, {"reason", reason}};
    for (const char* key : {"drivers", "source_text"})
      if (line.contains(key)) place[key] = line[key];
    places.push_back(std::move(place));
  };
  if (j.value("differs_alone", false)) {
    for (const Json& difference : j["first_differences"]) {
      if (difference["sources"].empty()) continue;
      // The line in the pipe's own text, not in the parts that all pipes use.
      const Json* own = nullptr;
      for (const Json& line : difference["sources"][0])
        if (own == nullptr || !is_wiring(line["file"])) own = &line;
      if (own != nullptr) add(*own, "an operator that differs");
      // Lines that feed the first operator precede other operators.
      for (const Json& line : j["near_lines"])
        if (places.size() == 1) add(line, "feeds it");
    }
    for (const Json& line : j["near_lines"]) add(line, "feeds it");
  }
  if (!places.empty() || !j.contains("cause_lines")) return places;
  // Wires and lines that only pass a word on come last.
  for (const bool wires : {false, true})
    for (const Json& line : j["cause_lines"])
      if (line["is_wire"] == wires) add(line, "made the signal wrong");
  return places;
}

std::string text_of_places(const Json& places) {
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Json& p = places[i];
    text += fmt::format("  {}. {}:{}, {}\n", i + 1, p["file"].get<std::string>(),
                        p["line"].get<int>(), p["reason"].get<std::string>());
    if (p.contains("source_text"))
      text += fmt::format("     {}\n", p["source_text"].get<std::string>());
  }
  return text;
}

/// The first lines of a text.
std::string beginning(const std::string& text) {
  std::size_t end = 0;
  for (std::size_t n = 0; n < kMostCauses; ++n) {
    const std::size_t next = text.find('\n', end);
    if (next == std::string::npos) return text;
    end = next + 1;
  }
  return end == text.size() ? text : text.substr(0, end) + "... more in why.txt\n";
}

}  // namespace

Bundle::Bundle(const std::string& folder) : folder_(new_folder(folder, made_)) {
  json_ = {{"schema", "cde.failure.1"}};
  json_.update(program_json());
}

Bundle::~Bundle() {
  for (const NameInFolder& one : written_) {
    ::unlinkat(one.folder, one.name.c_str(), 0);
    forget_unfinished(one);
  }
}

fs::path Bundle::file(std::string_view name) const {
  return fs::path(fmt::format("/proc/{}/fd/{}", ::getpid(), made_->descriptor())) / name;
}

fs::path Bundle::new_file(const std::string& name) {
  remember_unfinished(written_.emplace_back(made_->descriptor(), name));
  return file(name);
}

void Bundle::check() const {
  made_->check();
}

void Bundle::add(std::string_view heading, std::string_view text) {
  sections_.push_back(fmt::format("{}\n{:=<{}}\n\n{}{}", heading, "", heading.size(), text,
                                  text.ends_with('\n') ? "" : "\n"));
}

void Bundle::write(const std::string& name, std::string_view text) {
  write_file(new_file(name), text);
}

void Bundle::finish() {
  const Json places = places_to_look_at(json_);
  if (!places.empty()) {
    json_["places"] = places;
    add("Where to look first", text_of_places(places));
    std::rotate(sections_.begin() + 1, sections_.end() - 1, sections_.end());  // behind the message
  }
  write("fail.json", json_text(json_) + '\n');
  write("fail.txt", fmt::format("{}", fmt::join(sections_, "\n")));
  for (const NameInFolder& one : written_) forget_unfinished(one);
  written_.clear();
  made_->keep();
}

Packed pack(const std::string& folder, const Failure& f) {
  Bundle bundle(folder);
  Packed packed{bundle.folder(), ""};
  try {
    bundle.json().update(Json::parse(f.details));
    for (const auto& [name, text] : f.files) bundle.write(name, text);
    if (std::holds_alternative<PairFailure>(f.kind))
      bundle_pair(bundle, f);
    else if (std::holds_alternative<CardFailure>(f.kind))
      bundle_card(bundle, f);
    else
      bundle_hang(bundle, f);
  } catch (const Error& e) {  // keep the parts that are complete
    bundle.json()["error"] = e.what();
    bundle.add("What is missing", e.what());
    packed.missing = e.what();
  }
  bundle.finish();
  try {
    bundle.check();
  } catch (const Error& e) {
    packed.missing = e.what();
  }
  return packed;
}

void cut_waves(Bundle& bundle, const fs::path& whole, const WaveWindow& window) {
  wave::Trace trace(whole);
  wave::Times times(trace, "");
  const auto& edges = times.edges();
  const auto at = std::upper_bound(edges.begin(), edges.end(), window.fail);
  const auto number = static_cast<std::uint64_t>(at - edges.begin());  // edges up to it
  const std::uint64_t first = number > window.before ? number - window.before - 1 : 0;
  const std::uint64_t last = std::min<std::uint64_t>(number + window.behind, edges.size());
  const std::uint64_t from =
      edges.empty() || number <= window.before ? trace.start() : edges[first];
  const std::uint64_t to = last == edges.size() ? trace.end() : edges[last];
  const fs::path file = bundle.new_file("waves.fst");
  const std::vector<std::string> comments = {fmt::format("fail {}", window.fail)};
  wave::write_cut(trace, {}, from, to, file, comments);
  std::vector<wave::View> shown;
  for (const std::string& word : window.shown) {
    try {
      for (wave::View& v : wave::views(trace, word, wave::Form{})) shown.push_back(std::move(v));
    } catch (const Error&) {  // this signal is not in the waves
    }
  }
  wave::write_gtkw(trace, shown,
                   {.fail = window.fail,
                    .waves = bundle.folder() / "waves.fst",
                    .named = bundle.folder() / "waves.gtkw",
                    .from = from,
                    .to = to},
                   bundle.new_file("waves.gtkw"));
  bundle.json()["wave_window"] = {{"file", "waves.fst"},
                                  {"fail_time", window.fail},
                                  {"fail_at", times.text(window.fail)},
                                  {"fail_cycle", number == 0 ? Json() : Json(number - 1)},
                                  {"from", from},
                                  {"to", to}};
  std::string words;
  for (const std::string& word : window.first)
    words += fmt::format("{}{}", words.empty() ? "" : " ", shell_word(word));
  bundle.add("Waves", fmt::format("waves.fst, {} to {}; {} is at {}. In this folder:\n\n"
                                  "    cde wave show waves.fst {} --around fail --window 12\n"
                                  "    gtkwave waves.fst waves.gtkw\n",
                                  times.text(from), times.text(to), window.what,
                                  times.text(window.fail), words));
}

bool bundle_explanation(Bundle& bundle, const explain::Explanation& e, const std::string& options,
                        const std::string& words) {
  bundle.write("explain.txt", explanation_text(options, e, 0));
  const std::string again = fmt::format("cde explain {} '{}'", options, words);
  Json& j = bundle.json();
  j["explain_command"] = again;
  j["differs_alone"] = !e.same();
  j["first_differences"] = explanation_differences(e);
  j["near_lines"] = near_lines(e);
  std::string text;
  if (e.same()) {
    text = "Alone, the pipe answers the pair as the reference does.\n";
  } else if (e.findings.empty()) {
    text = "No operation of the pipe differs: the error is behind the operators.\n";
  } else {
    text = "Card and reference first differ in\n" + lines_of(e);
    std::string near;
    for (const Json& line : j["near_lines"])
      near += fmt::format("  {}:{}  {}\n", line["file"].get<std::string>(), line["line"].get<int>(),
                          line["source_text"].get<std::string>());
    if (!near.empty()) text += fmt::format("\nThe wrong words there come from\n{}", near);
  }
  text += fmt::format("\nAll operations are in explain.txt; again:\n\n    {}\n", again);
  bundle.add("Where they differ", text);
  return !e.same();
}

wave::Origin origin_at(const fs::path& file, const std::string& signal, std::uint64_t time) {
  try {
    wave::Trace trace(file);
    wave::Times times(trace, "");
    const wave::Design design = wave::Design::of(trace, "");
    const wave::Slice slice = wave::slice_named(trace, design, signal, signal, wave::Form{});
    return wave::origin_of(trace, times, design, slice, time);
  } catch (const Error&) {  // the causes are then not found either, and the bundle says so
    return {signal, time};
  }
}

void bundle_causes(Bundle& bundle, const std::string& signal, const wave::Origin& made) {
  wave::Request request;
  request.file = bundle.file("waves.fst").string();
  const std::string asked = fmt::format("{}@{}", made.signal, made.time);
  request.words = {asked};
  request.max = kCauses;
  request.depth = kDepth;
  Json& j = bundle.json();
  std::string text;
  try {
    text = wave::why_text(request);
    request.json = true;
    request.max = kMostNodes;
    const Json why = Json::parse(wave::why_text(request));
    // If no operator of a pipe differs, the wires in between are wrong.
    const bool wires = j.value("differs_alone", false) && j["first_differences"].empty();
    j["cause_lines"] = lines_of(why["cone"], !wires);
    j["made_signal"] = why["cone"]["name"];
    j["made_at"] = why["cone"]["at"];
  } catch (const Error& e) {
    text = fmt::format("the causes of {} cannot be found: {}\n", asked, e.what());
  }
  j["wrong_signal"] = signal;
  bundle.write("why.txt", text);
  bundle.add("What made the signal wrong",
             fmt::format("{} is wrong; where its word was made:\n\n{}\nFurther back, in this "
                         "folder:\n\n    cde wave why waves.fst {} --depth 10\n",
                         signal, beginning(text), shell_word(asked)));
}

Json result_json(const FpFormat& format, const PairResult& r) {
  const WordText text(format);
  Json cp = Json::array(), n = Json::array();
  for (const std::uint64_t word : r.cp) cp.push_back(text.hexfloat(word));
  for (const std::uint64_t word : r.n) n.push_back(text.hexfloat(word));
  return {{"F", r.f}, {"bad_input", r.bad}, {"T", text.hexfloat(r.t)}, {"CP", cp}, {"normal", n}};
}

Json record_json(const std::optional<Record>& r) {
  if (!r) return nullptr;
  return {{"F", r->f},
          {"bad_input", r->bad},
          {"T", fmt::format("{:a}", r->t)},
          {"CP",
           {fmt::format("{:a}", r->cp.x()), fmt::format("{:a}", r->cp.y()),
            fmt::format("{:a}", r->cp.z())}},
          {"index", r->index == ~0u ? Json() : Json(r->index)}};
}

}  // namespace cde
