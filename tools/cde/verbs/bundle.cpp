// SPDX-License-Identifier: Apache-2.0
#include "verbs/bundle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <system_error>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "command/values.hpp"
#include "command/words.hpp"
#include "output/busy.hpp"
#include "output/json_keys.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "verbs/explain_text.hpp"
#include "wave/design.hpp"
#include "wave/export.hpp"
#include "wave/nearby.hpp"
#include "wave/request.hpp"
#include "wave/trace.hpp"
#include "wave/value.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr unsigned kMostFolders = 1000;
constexpr std::uint64_t kCauses = 200;                     // lines of why.txt
constexpr std::size_t kMostOperators = 3, kMostNear = 24;  // whose operands are looked at
constexpr unsigned kSteps = 3;
constexpr std::size_t kMostLines = 10, kMostCauses = 24;  // lines of fail.txt

fs::path new_folder(const std::string& wanted) {
  for (unsigned n = 1; n <= kMostFolders; ++n) {
    const fs::path folder = n == 1 ? wanted : fmt::format("{}-{}", wanted, n);
    std::error_code error;
    if (fs::create_directory(folder, error)) return folder;
    if (error && error != std::errc::file_exists)
      throw Error(ErrorCode::kFile, fmt::format("{}: no folder can be made: {}",
                                                printable_name(folder.string()), error.message()));
  }
  throw Error(ErrorCode::kFile, fmt::format("{}: there are {} of them, none is overwritten",
                                            printable_name(wanted), kMostFolders));
}

/// Lines of the operators that part first, each with how many it has.
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
  if (lines.empty()) return "  operators that were not found\n";
  std::string text;
  for (std::size_t i = 0; i < lines.size() && i < kMostLines; ++i)
    text += fmt::format("  {}. {}, {} operator{}\n", i + 1, lines[i].first, lines[i].second,
                        lines[i].second == 1 ? "" : "s");
  if (lines.size() > kMostLines) text += fmt::format("  {} more\n", lines.size() - kMostLines);
  return text;
}

/// What a line of dataflow is made of, and what is around a pipe.
bool is_wiring(const std::string& file) {
  static const std::set<std::string> kAround = {"align.sv",     "lane_select.sv", "fp_lanes.sv",
                                                "fp_host.sv",   "fp_delay.sv",    "pair_pipe.sv",
                                                "pair_unit.sv", "scaled_pipe.sv"};
  return file.starts_with("df_") || file.starts_with("vec_") || kAround.contains(file);
}

/// Lines that the operands of the first operators come from, a few statements far.
Json near_lines(const explain::Explanation& e) {
  std::vector<std::string> signals;
  for (std::size_t i = 0; i < e.findings.size() && i < kMostOperators; ++i) {
    const explain::Compared& c = e.findings[i].compared;
    std::vector<std::int32_t> operators = c.others;
    if (c.seat.which >= 0) operators = {c.seat.which};
    for (const std::int32_t which : operators) {
      const std::string& path = e.operators[static_cast<std::size_t>(which)].path;
      const std::size_t top = path.find("pair_unit.", 1);  // behind Verilator's own name
      if (top == std::string::npos) continue;
      for (const char* port : {".a_i", ".b_i"})
        signals.push_back(path.substr(top, path.rfind('.') - top) + port);
    }
  }
  if (signals.empty()) return Json::array();
  PairConfig plain = e.config;
  plain.tap = false;
  const wave::Design design = wave::Design::of_bitstream("pair_unit", plain.parameters());
  Json lines = Json::array();
  for (const wave::Place& p : wave::fed_by(design, signals, kSteps, 4 * kMostNear)) {
    const std::string file = fs::path(p.file).filename().string();
    if (is_wiring(file) || lines.size() == kMostNear) continue;
    lines.push_back({{"file", file}, {"line", p.line}, {"source_text", p.text}});
  }
  return lines;
}

/// Lines of the statements of a cone, the nearest to its root first.
Json lines_of(const Json& cone) {
  Json lines = Json::array();
  std::vector<const Json*> nodes = {&cone};
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const Json& statement : (*nodes[i])["statements"]) {
      const Json line = {
          {"file", fs::path(statement["source_file"].get<std::string>()).filename().string()},
          {"line", statement["line"]}};
      if (line["file"] != "" && std::find(lines.begin(), lines.end(), line) == lines.end())
        lines.push_back(line);
      for (const Json& cause : statement["causes"]) nodes.push_back(&cause);
    }
  return lines;
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

void add_bundle_options(CLI::App& verb, BundleRequest& request) {
  folder_value(
      verb.add_option("--bundle", request.folder,
                      "Where an answer that differs is packed: waves around it, the line of RTL "
                      "where card and reference part, commands. One that is there stays, the next "
                      "is FOLDER-2")
          ->capture_default_str(),
      "FOLDER");
  verb.add_flag_callback(
      "--no-bundle", [&request] { request.wanted = false; }, "An answer that differs is only told");
}

Bundle::Bundle(const std::string& folder) : folder_(new_folder(folder)) {
  json_ = {{"schema", "cde.failure.1"}};
  json_.update(program_json());
}

void Bundle::add(std::string_view heading, std::string_view text) {
  page_ += fmt::format("{}{}\n{:=<{}}\n\n{}{}", page_.empty() ? "" : "\n", heading, "",
                       heading.size(), text, text.ends_with('\n') ? "" : "\n");
}

void Bundle::write(const std::string& name, std::string_view text) {
  write_file(folder_ / name, text);
}

void Bundle::finish() {
  write("fail.json", json_text(json_) + '\n');
  write("fail.txt", page_);
}

std::string packed(const BundleRequest& request, bool quiet,
                   const std::function<void(Bundle&)>& fill) {
  if (!request.wanted) return "";
  std::string why;
  try {
    Bundle bundle(request.folder);
    try {
      const Busy busy("packing the failure", quiet);
      fill(bundle);
    } catch (const Error& e) {  // what there is stays
      bundle.json()["error"] = e.what();
      bundle.add("What is missing", e.what());
      why = fmt::format(", not all of it: {}", e.what());
    }
    bundle.finish();
    return fmt::format("\npacked in:   {}{}", shell_word(bundle.folder().string()), why);
  } catch (const Error& e) {
    return fmt::format("\nnot packed:  {}", e.what());
  }
}

void keep_waves(Bundle& bundle, const fs::path& whole, const WaveWindow& window) {
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
  const fs::path file = bundle.folder() / "waves.fst";
  const std::vector<std::string> comments = {fmt::format("fail {}", window.fail)};
  wave::write_cut(trace, {}, from, to, file, comments);
  std::vector<wave::View> shown;
  for (const std::string& word : window.shown) {
    try {
      for (wave::View& v : wave::views(trace, word, wave::Form{})) shown.push_back(std::move(v));
    } catch (const Error&) {  // not in these waves
    }
  }
  wave::write_gtkw(trace, shown, {.fail = window.fail, .waves = file, .from = from, .to = to},
                   bundle.folder() / "waves.gtkw");
  bundle.json()["wave_window"] = {{"file", "waves.fst"},
                                  {"fail_time", window.fail},
                                  {"fail_at", times.text(window.fail)},
                                  {"fail_cycle", number == 0 ? Json() : Json(number - 1)},
                                  {"from", from},
                                  {"to", to}};
  std::string words;
  for (const std::string& word : window.first)
    words += fmt::format("{}{}", words.empty() ? "" : " ", shell_word(word));
  bundle.add("Waves",
             fmt::format("waves.fst, {} to {}; the wrong answer is at {}. In this folder:\n\n"
                         "    cde wave show waves.fst {} --around fail --window 12\n"
                         "    gtkwave waves.fst waves.gtkw\n",
                         times.text(from), times.text(to), times.text(window.fail), words));
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
    text = "The pair by itself, between others, is answered as the reference answers it.\n";
  } else if (e.findings.empty()) {
    text = "No operation of the pipe differs: what is wrong is behind the operators.\n";
  } else {
    text = "Card and reference part first in\n" + lines_of(e);
    std::string near;
    for (const Json& line : j["near_lines"])
      near += fmt::format("  {}:{}  {}\n", line["file"].get<std::string>(), line["line"].get<int>(),
                          line["source_text"].get<std::string>());
    if (!near.empty()) text += fmt::format("\nTheir operands come from\n{}", near);
  }
  text += fmt::format("\nAll operations are in explain.txt; again:\n\n    {}\n", again);
  bundle.add("Where they part", text);
  return !e.same();
}

void bundle_causes(Bundle& bundle, const std::string& signal) {
  wave::Request request;
  request.file = (bundle.folder() / "waves.fst").string();
  request.words = {signal + "@fail"};
  request.max = kCauses;
  std::string text;
  try {
    text = wave::why_text(request);
    request.json = true;
    bundle.json()["cause_lines"] = lines_of(Json::parse(wave::why_text(request))["cone"]);
  } catch (const Error& e) {
    text = fmt::format("{} has no causes that could be found: {}\n", signal, e.what());
  }
  bundle.json()["wrong_signal"] = signal;
  bundle.write("why.txt", text);
  bundle.add("What made the signal wrong",
             fmt::format("{}\nFurther back, in this folder:\n\n    cde wave why waves.fst {} "
                         "--depth 10\n",
                         beginning(text), shell_word(signal + "@fail")));
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

}  // namespace cde::cli
