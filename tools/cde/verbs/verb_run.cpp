// SPDX-License-Identifier: Apache-2.0
// cde run: runs the frames of a scene on the simulated card and compares its answers with the
// reference.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cde/card/json_keys.hpp"
#include "cde/card/machine.hpp"
#include "cde/card/trace_file.hpp"
#include "cde/contract/records.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/model/model.hpp"
#include "cde/scene/packet_again.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene_runner.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/suffix.hpp"
#include "options/device_options.hpp"
#include "options/distribution_options.hpp"
#include "options/help.hpp"
#include "options/scene_frames.hpp"
#include "options/trace_options.hpp"
#include "options/values.hpp"
#include "output/output.hpp"
#include "output/plan_output.hpp"
#include "output/run_folder.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"
#include "program/pack_failure.hpp"
#include "report/report.hpp"
#include "verbs/run_faults.hpp"
#include "verbs/run_frames.hpp"
#include "verbs/run_records.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, frames, out, check, report, device;
  TraceRequest trace;
  BundleRequest bundle;
  DistributionOptions distribution;
  std::vector<std::string> faults;
  double timeout = 3600;
  std::uint64_t deadline = 0;
  bool exact = false, json = false, quiet = false, file_per_frame = false;
  [[nodiscard]] RecordFiles files() const {
    return file_per_frame ? RecordFiles::kPerFrame : RecordFiles::kTables;
  }
};

std::string bus_name(const Scene& scene) {
  const SceneCard& c = scene.card;
  return fmt::format("{} (host {}, {} bits, bursts of {} bytes)",
                     c.cycle_bus ? "cycle" : "functional", c.host.name, c.narrow ? 32 : 64,
                     c.burst);
}
const char* memory_name(const Scene& scene) {
  return scene.card.device.narrow_memory ? "narrow" : scene.card.cycle_memory ? "cycle" : "ideal";
}

struct Totals {
  std::uint64_t records = 0, compared = 0, mismatches = 0, corrected = 0, hits = 0, tests = 0;
  std::uint64_t nodes = 0;  // nodes of a BVH that were read
  std::uint64_t asked = 0,
                uncertain = 0;  // pairs in queries with the certified filter; uncertain pairs
  std::uint64_t bad = 0;        // refused primaries and secondaries, counted each time
  double modelled = 0, simulated = 0, checked = 0;

  void add(const Json& q, const SceneQuery& query) {
    records += q["records"].get<std::uint64_t>();
    compared += q["records_compared"].get<std::uint64_t>();
    mismatches += q["mismatches"].get<std::uint64_t>();
    corrected += q["counters"]["corrected_words"].get<std::uint64_t>();
    hits += q["hits"].get<std::uint64_t>();
    tests += q["counters"]["tests"].get<std::uint64_t>();
    nodes += q["counters"]["nodes"].get<std::uint64_t>();
    if (has_filter(query.pair) && (query.mode == Mode::kHits || query.mode == Mode::kAny)) {
      asked += q["counters"]["tests"].get<std::uint64_t>();
      uncertain += q["counters"]["uncertain_pairs"].get<std::uint64_t>();
    }
    modelled += q["modelled_seconds"]["total"].get<double>();
    simulated += q["simulation_seconds"].get<double>();
    checked += q["reference_seconds"].get<double>();
  }
};

void check_files(const Options& o, const Scene& scene) {
  std::vector<FileUse> inputs = {{"SCENE", o.scene}};
  for (const SceneObject& object : scene.objects)
    inputs.push_back({fmt::format("object '{}'", printable_name(object.name)), object.file});
  for (const SceneObject& object : scene.objects)
    for (const auto& file : object.more_files)
      inputs.push_back({fmt::format("the mesh of object '{}'", printable_name(object.name)), file});
  WorkDistributor::instance().add_inputs(inputs);
  check_outputs(std::vector<FileUse>{{"--report", o.report},
                                     {"--trace", o.trace.file},
                                     {"--resume", o.distribution.resume},
                                     {"--json", o.json ? "-" : ""}},
                inputs);
  check_suffix("--report", o.report, ".html");
  if (!o.report.empty()) need_three("--report");
  o.trace.check();
}

/// A run: the frames simulated so far, and its outputs.
class Run {
 public:
  Run(const Options& o, Scene& scene, const Plan& plan, Check check)
      : o_(o),
        scene_(scene),
        check_(check),
        frames_(frames_of(o.frames, scene)),
        faults_(faults_of(o.faults, plan, frames_.first, frames_.last)),
        folder_(o.out.empty() ? fs::path(scene.file).stem().string() + ".run" : o.out, scene,
                {o.report, o.trace.file}),
        records_(scene, o.files()) {
    check_files(o, scene);
    json_ = program_json();
    json_.update(card_json(plan.board));
    json_.update(Json{{"model", nullptr}, {"config_hash", nullptr}});  // until the model is loaded
    json_.update({{"scene", scene.file},
                  {"title", scene.title},
                  {"frames", {frames_.first, frames_.last}},
                  {"rate", scene.rate},
                  {"check", name_of(check)},
                  {"clock_hz", scene.card.device.clock_hz()},
                  {"bus", bus_name(scene)},
                  {"memory", memory_name(scene)},
                  {"machine", machine_json()},
                  {"plan", plan_json(scene, plan)},
                  {"files", table_names(scene, o.files())},
                  {"files_beside", folder_.beside()},
                  {"frame_results", Json::array()}});
    if (!o.report.empty()) {
      page_.emplace(o.report);
      report_.emplace(scene);
    }
  }

  void simulate(const Plan& plan) {
    std::optional<Interrupts> interrupts;  // once there is a card; before, a signal ends the build
    std::optional<OutputFile> waves;
    if (o_.trace.wanted()) waves.emplace(o_.trace.file, OutputFile::Use::kByName);
    try {
      (void)model_path(plan.board.top(), plan.board.parameters());  // prints its own progress
      std::optional<Progress> uploading(std::in_place, "uploading the scene", o_.quiet);
      std::optional<Progress> bar;
      SceneRunner runner(
          scene_, plan,
          {.check = check_,
           .trace = waves ? waves->by_name() : "",
           .waves = o_.trace.options(),
           .watchdog = std::chrono::duration<double>(o_.timeout),
           .deadline_cycles = o_.deadline,
           .faults = faults_,
           .progress = [&](std::uint32_t frame, double share) {
             if (Interrupts::signal() != 0) throw Stopped();
             note_progress(frame, share);
             if (bar)
               (*bar)((frame - frames_.first + share) / (frames_.last - frames_.first + 1.0));
           }});
      uploading.reset();
      runner_ = &runner;
      began_ = runner.board().cycles();
      interrupts.emplace();
      bar.emplace("simulating", o_.quiet);
      json_["plan"]["model"] = runner.board().model_path().string();
      json_["plan"]["built"] = true;
      json_.update(model_json(runner.board().model_path(), runner.board().config_hash()));
      begin();
      try {
        for (std::uint32_t f = frames_.first; f <= frames_.last && totals_.mismatches == 0; ++f)
          simulate_frame(runner, f);
        end_records();
      } catch (...) {
        count_faults(runner);
        end_waves(runner);
        throw;
      }
      count_faults(runner);
      end_waves(runner);
    } catch (const Stopped&) {
    } catch (const Error& e) {
      json_["error"] = e.what();
      finish(waves);
      report_faults();
      if (!waves_defect_.empty()) log("cde: {}\n", waves_defect_);
      if (!is_hang(e) || !faults_.empty() || o_.deadline != 0) throw;
      throw Error(e.code(), e.what() + pack_hang(plan, e), e.fault());
    }
    finish(waves);
    if (Interrupts::signal() != 0 && o_.trace.wanted()) say_stopped(o_.trace.file, last_);
    if (failure_.difference && faults_.empty()) pack(plan);
    if (!waves_defect_.empty()) throw Error(ErrorCode::kFile, waves_defect_);
  }

  /// Plays the frames in chunks of one frame.
  void distribute(const Plan& plan) {
    json_["config_hash"] = WorkDistributor::instance().config_hash();
    if (!WorkDistributor::instance().merges())  // only on rank 0; each host has its own model
      json_["model"] = model_file(plan.board.top(), plan.board.parameters()).path.string();
    begin();
    (void)distribute_frames(
        {.scene = scene_,
         .plan = plan,
         .check = check_,
         .files = o_.files(),
         .first = frames_.first,
         .last = frames_.last,
         .timeout = o_.timeout,
         .deadline = o_.deadline},
        [&](std::uint32_t frame, const Json& j, const std::vector<std::string>& records) {
          records_.begin_frame(frame);
          for (std::size_t q = 0; q < records.size(); ++q) records_.add_text(q, records[q]);
          records_.end_frame();
          add_frame(frame, j);
        });
    end_records();
    std::optional<OutputFile> no_waves;
    finish(no_waves);
  }

  /// Error kFile if the folder is no longer at its path.
  void check_folder() const {
    if (folder_.begun()) folder_.check();
  }

  void report() const {
    const Totals& t = totals_;
    if (o_.json) print_json(json_);
    const std::size_t simulated = json_["frame_results"].size();
    if (!o_.quiet) {
      row("scene", printable_name(scene_.file));
      row("frames", fmt::format("{} of {}..{}", simulated, frames_.first, frames_.last));
      row("tests",
          fmt::format("{}{}, {}, {}", t.tests, t.nodes == 0 ? "" : ", " + counted(t.nodes, "node"),
                      counted(t.records, "record"), counted(t.hits, "hit")));
      if (scene_.card.filter)
        row("filter", t.asked == 0 ? "no query leaves out misses; the wide lane tested all pairs"
                                   : fmt::format("{} lanes were uncertain about {} of {}, {:.3g} %",
                                                 scene_.card.filter->name(), t.uncertain,
                                                 counted(t.asked, "pair"),
                                                 100 * static_cast<double>(t.uncertain) /
                                                     static_cast<double>(t.asked)));
      row("modelled time",
          fmt::format("{:.6g} ms per frame on {}, bus {}, memory {}",
                      simulated == 0 ? 0 : 1e3 * t.modelled / static_cast<double>(simulated),
                      scene_.card.device.text(), bus_name(scene_), memory_name(scene_)));
      // A run that stops early has no tests.
      const double rate = t.tests == 0 ? 0 : static_cast<double>(t.tests) / t.simulated / 1e6;
      row("simulation",
          fmt::format("{:.3g} s{}; reference {:.3g} s", t.simulated,
                      t.nodes == 0 ? fmt::format(", {:.4g} M tests/s", rate) : "", t.checked));
      if (t.bad != 0)
        row("bad input", fmt::format("{} primaries and secondaries, see above", t.bad));
      row("check", check_text());
      report_faults();
      row("results", folder_.begun()
                         ? fmt::format("{}/run.json", printable_name(folder_.path().string()))
                         : "none; the run did not begin");
      if (report_) row("report", printable_name(o_.report));
    }
    if (t.mismatches != 0) throw Error(ErrorCode::kMismatch, mismatch_ + packed_);
    if (const int signal = Interrupts::signal()) exit_code = 128 + signal;
  }

 private:
  struct Stopped {};

  void note_progress(std::uint32_t frame, double share) {
    if (frame == frame_ && share == share_) return;
    seen_ = before_;
    frame_ = frame;
    share_ = share;
    if (runner_ != nullptr) before_ = runner_->board().cycles() - began_;
  }
  [[nodiscard]] RunnerOptions options_again() const {
    return {.check = Check::kNone,
            .watchdog = std::chrono::duration<double>(o_.timeout),
            .deadline_cycles = o_.deadline};
  }

  std::string pack_hang(const Plan& plan, const Error& error) {
    cde::Failure f{.kind = HangFailure{.cycle = seen_},
                   .message = error.what(),
                   .repeat = fmt::format("cde run {} --frames {}..{}", shell_word(scene_.file),
                                         frames_.first, frame_)};
    f.rerun = [&](const std::string& file, const TraceOptions& which) {
      Plan traced = plan;
      traced.board.trace = true;
      RunnerOptions options = options_again();
      options.trace = file;
      options.waves = which;
      SceneRunner runner(scene_, traced, options);
      try {
        for (std::uint32_t frame = frames_.first; frame <= frame_; ++frame) runner.run_frame(frame);
      } catch (const Error& e) {
        if (!is_hang(e)) throw;
      }
      runner.trace_close();
      return true;
    };
    return packed(o_.bundle, o_.quiet, f);
  }

  void pack(const Plan& plan) {
    packed_ = packed(o_.bundle, o_.quiet,
                     failure_of({.scene = scene_,
                                 .plan = plan,
                                 .options = options_again(),
                                 .first = frames_.first,
                                 .frame = failure_.frame,
                                 .query = failure_.query,
                                 .difference = *failure_.difference,
                                 .message = mismatch_,
                                 .repeat = failure_.repeat}));
  }

  static void row(const char* name, const std::string& value) { log("{:<16} {}\n", name, value); }

  void count_faults(const SceneRunner& runner) {
    if (!faults_.empty()) json_["faults"] = faults_json(faults_, runner, totals_.corrected);
  }
  void report_faults() const {
    if (!o_.quiet && json_.contains("faults")) row("faults", faults_text(json_["faults"]));
  }

  void begin() {
    folder_.begin(json_);
    records_.begin(folder_.inside());
  }
  /// Completes the tables if they have every frame.
  void end_records() {
    if (json_["frame_results"].size() != frames_.last - frames_.first + 1) return;
    records_.commit();
    finished_ = true;
  }

  void simulate_frame(SceneRunner& runner, std::uint32_t frame) {
    records_.begin_frame(frame);
    const auto start = std::chrono::steady_clock::now();
    const std::vector<QueryFrame> answers =
        runner.run_frame(frame, [&](std::size_t query, std::span<const Record> records) {
          records_.add(query, records);
          if (report_) report_->records(query, records);
        });
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    records_.end_frame();
    if (report_) report_->frame(frame, answers);
    add_frame(frame, frame_json(scene_, frame, wall.count(), frame_names(scene_, frame, o_.files()),
                                answers));
    for (std::size_t q = 0; q < answers.size(); ++q) {
      if (answers[q].mismatches == 0 || !mismatch_.empty()) continue;
      const std::string repeat = repeat_of(scene_, frame, check_) + fault_words();
      mismatch_ = mismatch_text(scene_, frame, q, answers[q], repeat, !o_.faults.empty());
      failure_ = {frame, q, answers[q].first_difference, repeat};
    }
  }

  /// Adds a simulated frame, from this process or from a chunk.
  void add_frame(std::uint32_t frame, const Json& j) {
    for (std::size_t q = 0; q < scene_.queries.size(); ++q) {
      const Json& counters = j["queries"][q]["counters"];
      totals_.add(j["queries"][q], scene_.queries[q]);
      warn_of_bad(scene_.queries[q].name, frame, counters["bad_primaries"].get<std::uint64_t>(),
                  counters["bad_secondaries"].get<std::uint64_t>());
      const Json why = j["queries"][q].value("brute_force_reason", Json());
      if (!why.is_null() && brute_force_.insert(scene_.queries[q].name).second)
        log("cde: warning: frame {}, query '{}': brute force instead of a BVH: {}\n", frame,
            scene_.queries[q].name, why.get<std::string>());
    }
    json_["frame_results"].push_back(j);
  }

  [[nodiscard]] std::string fault_words() const {
    std::string words;
    for (const std::string& fault : o_.faults) words += " --fault " + shell_word(fault);
    return words;
  }

  /// Warns once per query about bad input, because a body outside the input contract's range is not
  /// a miss.
  void warn_of_bad(const std::string& query, std::uint32_t frame, std::uint64_t primaries,
                   std::uint64_t secondaries) {
    const std::uint64_t bad = primaries + secondaries;
    totals_.bad += bad;
    if (bad == 0 || !warned_.insert(query).second) return;
    const LengthRange range = LengthRange::of(8, 23);
    log("cde: frame {}, query '{}': {} of its primaries and {} of its secondaries are bad input "
        "(not finite, beyond 2^{}, a size below 2^{}, or not of unit length); their records have "
        "the flag bad and are no hits\n",
        frame, query, primaries, secondaries, range.high, range.low);
  }

  /// Closes the waves, also after a failure, when they are most useful. They are kept if they are
  /// whole.
  void end_waves(SceneRunner& runner) {
    try {
      runner.trace_close();
      waves_whole_ = true;
    } catch (const Error& e) {
      waves_defect_ = fmt::format("{}: {}", printable_name(o_.trace.file), e.what());
    }
  }

  void finish(std::optional<OutputFile>& waves) {
    if (waves && waves_whole_) {
      if (const auto times = trace_times(waves->by_name())) last_ = times->second;
      waves->commit();
    }
    const Totals& t = totals_;
    json_["finished"] = finished_;
    if (const int signal = Interrupts::signal()) json_["stopped_by_signal"] = signal;
    json_["totals"] = {{"tests", t.tests},
                       {"records", t.records},
                       {"hits", t.hits},
                       {"records_compared", t.compared},
                       {"records_matching", t.compared - std::min(t.compared, t.mismatches)},
                       {"mismatches", t.mismatches},
                       {"modelled_seconds", {{"total", t.modelled}}},
                       {"simulation_seconds", t.simulated},
                       {"reference_seconds", t.checked}};
    if (!folder_.begun()) return;  // an earlier run in the folder stays
    folder_.write(json_);
    if (!report_ || Interrupts::signal() != 0) return;  // an old page stays
    page_->write(report_->html(json_));
    page_->commit();
  }

  [[nodiscard]] std::string check_text() const {
    const Totals& t = totals_;
    if (check_ == Check::kNone) return "skipped: no record was compared with the reference";
    const char* sample = check_ == Check::kSample ? ", a sample" : "";
    return fmt::format("{} of {} compared with the reference{}, {} {}", t.compared,
                       counted(t.records, "record"), sample, t.mismatches,
                       t.mismatches == 1 ? "differs" : "differ");
  }

  const Options& o_;
  const Scene& scene_;
  Check check_;
  Frames frames_;
  std::vector<ScheduledFault> faults_;
  RunFolder folder_;
  RunRecords records_;
  Json json_;
  bool finished_ = false;
  std::optional<OutputFile> page_;
  std::optional<Report> report_;
  Totals totals_;
  std::string mismatch_, packed_;
  // Where the card last made progress.
  const SceneRunner* runner_ = nullptr;
  std::uint64_t began_ = 0, seen_ = 0, before_ = 0;
  std::uint32_t frame_ = 0;
  double share_ = 0;
  struct Failure {
    std::uint32_t frame = 0;
    std::size_t query = 0;
    std::optional<Difference> difference;
    std::string repeat;
  } failure_;
  std::set<std::string> warned_, brute_force_;  // names of queries with such a warning
  bool waves_whole_ = false;
  std::optional<std::uint64_t> last_;  ///< time of the waves, ps
  std::string waves_defect_;
};

/// Refuses options that cannot be combined, before the scene is read.
void check_options(const Options& o) {
  o.bundle.check(o.check != "none", "--check none");
  if (WorkDistributor::instance().is_chunked(o.distribution) &&
      (o.trace.wanted() || !o.report.empty() || !o.faults.empty()))
    throw Error(ErrorCode::kUsage,
                "--trace, --report and --fault work only in one process; they cannot be combined "
                "with ranks, --resume or --shard");
}

void run(const Options& o) {
  check_options(o);
  Scene scene = read_scene(o.scene, o.quiet);
  Check check = scene.check;
  if (!o.check.empty()) {
    const auto asked = check_named(o.check);
    if (!asked)
      throw Error(ErrorCode::kUsage,
                  fmt::format("--check is '{}'; it must be all, sample or none", o.check));
    check = *asked;
  }
  if (WorkDistributor::instance().leads()) warn(scene.warnings);
  if (o.trace.wanted()) scene.card.trace = true;
  use_device(o.device, scene);
  Plan made = plan(scene);
  scene.card.device = device_for(scene.card.device, made.board);
  if (!o.exact) use_built_card(scene, made);
  const bool distributed = WorkDistributor::instance().is_chunked(o.distribution);
  if (distributed) {
    made.board = WorkDistributor::instance().shared(made.board);
    const Frames frames = frames_of(o.frames, scene);
    const DistributedFrames all{.scene = scene,
                                .plan = made,
                                .check = check,
                                .files = o.files(),
                                .first = frames.first,
                                .last = frames.last,
                                .timeout = o.timeout,
                                .deadline = o.deadline};
    check_files(o, scene);
    begin_frames(o.distribution, all, o.quiet);
    if (!WorkDistributor::instance().leads() || WorkDistributor::instance().is_shard())
      return (void)distribute_frames(all, {});
  }
  Run run(o, scene, made, check);
  if (made.stands_in_for && !o.quiet)
    log("cde: {}\n", stand_in_text(made.board, *made.stands_in_for));
  if (distributed)
    run.distribute(made);
  else
    run.simulate(made);
  run.report();
  run.check_folder();
}

}  // namespace

void add_run(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("run",
                                      "Run a scene on the simulated card, compare the records with "
                                      "the reference, and write run.json");
  scene_option(*verb, o->scene);
  begin_group(*verb, "Run");
  frames_option(*verb, o->frames);
  text_value(
      verb->add_option("--fault", o->faults,
                       "Inject a bus or memory error, KIND[:COUNT[:VALUE]]@FRAME; repeatable")
          ->allow_extra_args(false),
      "FAULT", [](const std::string& text) { (void)fault_of(text); });
  scene_device_option(*verb, o->device);
  exact_card_option(*verb, o->exact);
  begin_group(*verb, "Outputs");
  folder_value(verb->add_option("-o,--output,--out", o->out,
                                "Folder for run.json and records: new, empty, or with an earlier "
                                "run, which is removed")
                   ->default_str("SCENE.run"),
               "FOLDER");
  verb->add_flag("--file-per-frame", o->file_per_frame,
                 "Write one file of records per query and frame, not one table per query. A run "
                 "that is stopped keeps these files");
  file_value(verb->add_option("--report", o->report,
                              "Page about the run: one HTML file that loads nothing (- is stdout)"),
             "FILE.html");
  begin_group(*verb, "Checks and limits");
  one_of(
      verb->add_option("--check", o->check, "Records to compare, in place of the scene's setting"),
      {"all", "sample", "none"});
  add_bundle_options(*verb, o->bundle);
  deadline_options(*verb, o->deadline, o->timeout, "pass");
  begin_group(*verb, "Waves");
  add_trace_options(*verb, o->trace, "Waves of the run, FST (- is stdout); kept even if it fails");
  begin_group(*verb, "Several machines");
  add_distribution_options(*verb, o->distribution);
  begin_group(*verb, "Messages");
  verb->add_flag("--json", o->json, "Also print run.json on stdout");
  verb->add_flag("-q,--quiet", o->quiet, "No summary and no progress");
  verb->callback([o] {
    report_builds(!o->quiet);
    run(*o);
  });
}

}  // namespace cde::cli
