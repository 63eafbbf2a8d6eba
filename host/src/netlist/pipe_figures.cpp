// SPDX-License-Identifier: Apache-2.0
#include "cde/netlist/pipe_figures.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cde/model/cache_entry.hpp"
#include "cde/model/model.hpp"
#include "cde/netlist/cache_name.hpp"
#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/progress.hpp"

namespace cde::netlist {
namespace {

/// The top module for elaborating the pipe: the pipe's own module, once it is known. An iterative
/// pipeline with cylinders stays inside the unit that sets its parameters.
std::string top(const Pipe& pipe) {
  if (has_iterations(pipe.pair)) return "pair_unit";
  return pipe.module.empty() ? "pair_pipe" : pipe.module;
}

/// The pipe's place in the elaborated design.
std::string path(const Pipe& pipe) {
  return top(pipe) == pipe.module ? pipe.module : top(pipe) + ".pipe";
}

Elaboration elaborate(const Pipe& pipe, const Profile& p, const Hidden& hidden) {
  const std::filesystem::path folder = model_builder().parent_path().parent_path() / "rtl";
  const bool alone = top(pipe) == pipe.module;
  // Host arithmetic has the same operators and latency, and elaborates faster. But only gates share
  // SAT units and have operators of the box rule.
  std::vector<std::string> parameters = {
      fmt::format("ARITH={}", pipe.sat_interval == 1 && !pipe.box ? "host" : "rtl")};
  if (!alone) parameters.push_back(fmt::format("PAIR={}", static_cast<unsigned>(pipe.pair)));
  if (!alone)
    parameters.push_back(fmt::format("ALGORITHM={}", static_cast<unsigned>(pipe.algorithm)));
  if (!alone || has_sat_interval(pipe.pair))
    parameters.push_back(fmt::format("SAT_II={}", pipe.sat_interval));
  if (!alone || pipe.box) parameters.push_back(fmt::format("BOX={}", pipe.box ? 1 : 0));
  if (!has_iterations(pipe.pair)) {
    parameters.push_back(latency_parameter(p.add, p.mul, p.div, p.sqrt, p.cmp));
  } else {
    parameters.insert(parameters.end(),
                      {fmt::format("LAT_ADD={}", p.add), fmt::format("LAT_MUL={}", p.mul),
                       fmt::format("LAT_DIV={}", p.div), fmt::format("LAT_SQRT={}", p.sqrt),
                       fmt::format("LAT_CMP={}", p.cmp)});
  }
  return {folder, top(pipe), parameters, hidden};
}

/// The last module of every ray pipe for a solid.
constexpr std::string_view kCrossing = "ray_crossing";

/// The pipe's own latency, or the latency of its crossing module.
std::optional<unsigned> latency(const Elaboration& e, const Pipe& pipe) {
  const auto own = e.constant(path(pipe), "LATENCY");
  return own ? own : e.constant(path(pipe) + ".crossing", "LATENCY");
}

unsigned required(const std::optional<unsigned>& value, const Pipe& pipe, const char* what) {
  if (!value)
    throw Error(ErrorCode::kBuild, fmt::format("{}: the pipe has no {}", pipe.name(), what));
  return *value;
}

/// Runs three elaborations: for the pipe's module, for its operators, and for its latency in the
/// profile, which is a constant of the module. Each hides modules that it does not need, because
/// Verilator takes a second for all pipes behind pair_pipe. Adds 2 to `done`. Error kBuild if the
/// RTL cannot be elaborated, except if there is no such pipe.
void examine(Pipe& pipe, const Profile& profile, std::atomic<std::size_t>& done) {
  try {
    pipe.module.clear();
    pipe.module = elaborate(pipe, {}, [](std::string_view) { return true; }).module_of(path(pipe));
    const Elaboration e = elaborate(pipe, {}, [](std::string_view module) {
      return is_gates(module) ||
             module == "bounded_pipe";  // through it, pair_unit instantiates other pipes
    });
    ++done;
    const auto words = [&](const char* port) { return e.bits(path(pipe), port).value_or(0) / 32; };
    pipe.operators = e.operators(path(pipe));
    pipe.a_words = words("a_i");
    pipe.b_words = words("b_i");
    pipe.outputs = words("f_o") + words("t_o") + words("cp_o") + words("n_o");
    pipe.latency = required(latency(e, pipe), pipe, "localparam LATENCY");
    pipe.interval = e.constant(path(pipe), "INTERVAL").value_or(pipe.sat_interval);
    if (has_iterations(pipe.pair))
      pipe.slots = required(e.constant(path(pipe), "SLOTS"), pipe, "SLOTS");
    pipe.latency_profile = pipe.latency;
    if (profile == Profile{}) return void(++done);
    const Elaboration slow = elaborate(pipe, profile, [&](std::string_view module) {
      return module != pipe.module && module != kCrossing;
    });
    pipe.latency_profile = required(latency(slow, pipe), pipe, "localparam LATENCY");
  } catch (const ElaborationError& error) {
    const std::string what = error.what();
    if (what.find(kNoPipe) == std::string::npos) throw Error(ErrorCode::kBuild, what);
    pipe.absent = kNoPipe;
    ++done;
  }
  ++done;
}

// ---- Cached figures ----

/// Figures of pipes in the cache. They stay valid until the RTL or the code that reads it changes.
class Kept {
 public:
  Kept() {
    if (const auto name = cache_name("pair_unit", {}, ".inventory.json")) {
      name_ = *name;
      if (const auto text = read_cache_entry(name_)) all_ = parse_json(*text);
    }
    if (!all_.is_object()) all_ = Json::object();
  }

  /// Fills in the pipe's figures from the cache; false if they are not there.
  bool fill(Pipe& pipe, const Profile& profile) const {
    const auto at = all_.find(key(pipe, profile));
    if (at == all_.end()) return false;
    try {
      const Json& j = *at;
      j.at("absent").get_to(pipe.absent);
      j.at("module").get_to(pipe.module);
      std::size_t i = 0;
      for (unsigned* figure : figures(pipe)) j.at("figures").at(i++).get_to(*figure);
    } catch (const Json::exception&) {
      return false;
    }
    return true;
  }
  void keep(Pipe& pipe, const Profile& profile) {
    Json list = Json::array();
    for (const unsigned* figure : figures(pipe)) list.push_back(*figure);
    all_[key(pipe, profile)] = {
        {"absent", pipe.absent}, {"module", pipe.module}, {"figures", list}};
  }
  void write() const {
    if (!name_.empty()) write_cache_entry(name_, all_.dump());
  }

 private:
  using Json = nlohmann::ordered_json;
  static std::string key(const Pipe& pipe, const Profile& profile) {
    return fmt::format("{}{}; SAT interval {}; {}", pipe.name(), pipe.box ? ", box" : "",
                       pipe.sat_interval, profile.text());
  }
  static std::array<unsigned*, 15> figures(Pipe& p) {
    Operators& o = p.operators;
    return {&o.multipliers, &o.dividers, &o.square_roots,    &o.adders,   &o.subtractors,
            &o.comparators, &o.min_max,  &o.mask_ands,       &p.a_words,  &p.b_words,
            &p.outputs,     &p.latency,  &p.latency_profile, &p.interval, &p.slots};
  }

  std::string name_;
  Json all_ = Json::object();
};

}  // namespace

void examine_all(std::vector<Pipe>& wanted, const Profile& profile) {
  Kept kept;
  std::vector<Pipe*> pipes;
  for (Pipe& pipe : wanted)
    if (!kept.fill(pipe, profile)) pipes.push_back(&pipe);
  if (pipes.empty()) return;
  std::atomic<std::size_t> next = 0, done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < pipes.size(); i = next++) examine(*pipes[i], profile, done);
  };
  std::vector<std::future<void>> workers;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
    workers.push_back(std::async(std::launch::async, work));
  {
    Progress progress("elaborating the pipes");
    for (auto& worker : workers)
      while (worker.wait_for(std::chrono::milliseconds(200)) != std::future_status::ready)
        progress(static_cast<double>(done) / (2.0 * static_cast<double>(pipes.size())));
  }
  for (auto& worker : workers) worker.get();
  for (Pipe* pipe : pipes) kept.keep(*pipe, profile);
  kept.write();
}

}  // namespace cde::netlist
