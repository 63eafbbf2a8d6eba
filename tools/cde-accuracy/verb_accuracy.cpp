// SPDX-License-Identifier: Apache-2.0
// cde accuracy: measures the accuracy of formats, algorithms and iterations, and their costs.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "accuracy/accuracy_page.hpp"
#include "accuracy/accuracy_report.hpp"
#include "accuracy/names.hpp"
#include "cde/accuracy/cost.hpp"
#include "cde/accuracy/filters.hpp"
#include "cde/accuracy/picture.hpp"
#include "cde/accuracy/profiles.hpp"
#include "cde/accuracy/saved_sweep.hpp"
#include "cde/accuracy/scene_accuracy.hpp"
#include "cde/accuracy/simulated.hpp"
#include "cde/accuracy/sweep.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/card/machine.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/image/camera.hpp"
#include "cde/jobs/work_distributor.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/suffix.hpp"
#include "options/device_options.hpp"
#include "options/distribution_options.hpp"
#include "options/help.hpp"
#include "options/pair_options.hpp"
#include "options/scene_frames.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "output/device_output.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

struct AccuracyOptions {
  std::vector<std::string> pairs, formats, algorithms, iterations, families;
  std::vector<std::string> variants = {"card"};
  std::string box = "both", output, mesh, grid = "64x48", camera;
  std::string target = kDefaultTarget, device, page, from;
  std::uint64_t cases = 2400, seed = 1, check = 0, profile_cases = 0;
  std::string scene, frames;
  DistributionOptions distribution;
  bool json = false, markdown = false, by_family = false, operators = true, quiet = false;
  bool short_json = false, promises = false, filters = false;
};

bool wanted(const std::vector<std::string>& list, std::string_view word) {
  return list.empty() || std::ranges::find(list, word) != list.end();
}

void add_ray_triangle(std::vector<AccuracyPipe>& pipes, const AccuracyOptions& o, FpFormat format) {
  for (const std::string& algorithm : algorithm_names()) {
    if (!wanted(o.algorithms, algorithm)) continue;
    for (const bool box : {false, true})
      if (o.box == "both" || (o.box == "on") == box)
        pipes.push_back({.algorithm = *algorithm_named(algorithm), .box = box, .format = format});
  }
}

/// The requested iterations of a pair, each setting once, in the given order.
std::vector<PairIterations> iteration_settings(const AccuracyOptions& o, Pair pair) {
  std::vector<PairIterations> settings;
  for (const std::string& text : o.iterations) {
    const PairIterations iterations = iterations_named(text, pair, "--iterations");
    if (std::ranges::find(settings, iterations) == settings.end()) settings.push_back(iterations);
  }
  return settings;
}

/// The card's pipes: for each pair its formats, and for each format its algorithms or iterations.
std::vector<AccuracyPipe> card_pipes(const AccuracyOptions& o) {
  std::vector<AccuracyPipe> pipes;
  bool iterations_used = o.iterations.empty();
  for (const std::string& name : pair_names()) {
    if (!wanted(o.pairs, name)) continue;
    const Pair pair = *pair_named(name);
    for (const std::string& word : pair_formats()) {
      if (!wanted(o.formats, word)) continue;
      const FpFormat format = FpFormat::parse(word);
      if (pair == Pair::kRayTriangle) {
        add_ray_triangle(pipes, o, format);
      } else if (has_iterations(pair) && !o.iterations.empty()) {
        iterations_used = true;
        for (const PairIterations& iterations : iteration_settings(o, pair))
          pipes.push_back({.pair = pair, .format = format, .iterations = iterations});
      } else {
        pipes.push_back({.pair = pair, .format = format});
      }
    }
  }
  if (!iterations_used)
    throw Error(ErrorCode::kUsage,
                "--iterations cannot be combined with these pairs; expected cylinder-cylinder, "
                "obb-cylinder or triangle-cylinder among them");
  return pipes;
}

/// The card's pipes, each followed by its requested variants.
std::vector<AccuracyPipe> pipes_of(const AccuracyOptions& o) {
  std::vector<AccuracyPipe> all;
  for (AccuracyPipe pipe : card_pipes(o))
    for (const Variant variant : variants()) {
      if (!wanted(o.variants, name(variant)) || !has_variant(pipe.pair, variant)) continue;
      pipe.variant = variant;
      all.push_back(pipe);
    }
  if (all.empty())
    throw Error(ErrorCode::kUsage, fmt::format("none of the pairs has the variant of --variants {}",
                                               fmt::join(o.variants, ",")));
  return all;
}

/// The families, each once, in the given order.
std::vector<std::string> families_of(const AccuracyOptions& o) {
  std::vector<std::string> families;
  for (const std::string& family : o.families)
    if (std::ranges::find(families, family) == families.end()) families.push_back(family);
  return families;
}

/// Refuses unknown families, and families of other pairs, before any work starts.
void check_families(const AccuracyOptions& o, const std::vector<AccuracyPipe>& pipes) {
  const std::vector<std::string> known = family_names(pipes);
  for (const std::string& family : o.families)
    if (std::ranges::find(known, family) == known.end())
      throw Error(ErrorCode::kUsage, fmt::format("no family {}; there are: {}", in_quotes(family),
                                                 fmt::join(known, ", ")));
}

void write(const AccuracyOptions& o, const std::string& text) {
  OutputFile file(o.output.empty() ? "-" : o.output);
  file.write(text);
  file.commit();
}

void say_what(const AccuracyOptions& o, const Json& machine, const std::string& what) {
  if (o.quiet || o.json || !WorkDistributor::instance().leads()) return;
  log("cde: {}, seed {}, {}\n", what, o.seed, machine.value("processor", std::string()));
}

Json head_json(const char* schema) {
  Json all = program_json();
  all["schema"] = schema;
  all["machine"] = machine_json();
  return all;
}

/// Writes the page of a sweep. Its file is opened before the work.
void write_page(OutputFile& file, const AccuracyOptions& o, const Json& sweep,
                const std::string& where) {
  const Target target = parse_target(o.target);
  file.write(accuracy_html(sweep_of(sweep, where, target), target));
  file.commit();
  if (!o.quiet) log("page: {}\n", printable_name(o.page));
}

/// JSON with one line per configuration and without the families.
std::string short_json(Json all) {
  const Json configurations = std::move(all["configurations"]);
  all["configurations"] = Json::array();
  std::string text = json_text(all, -1);
  text.resize(text.rfind("[]") + 1);
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    Json one = configurations[i];
    one["families"] = Json::array();
    text += (i == 0 ? "\n" : ",\n") + json_text(one, -1);
  }
  return text + "]}\n";
}

/// The measured rows, or nothing if not all results are in this process.
std::optional<std::vector<AccuracyRow>> measured_rows(const AccuracyOptions& o,
                                                      const SweepOptions& options) {
  const CostTable table = CostTable::of_project();  // before the long work
  std::optional<std::vector<Measured>> all = sweep(options);
  if (!all) return std::nullopt;
  std::vector<AccuracyRow> rows;
  for (Measured& measured : *all) rows.push_back({std::move(measured), {}, {}});
  std::vector<AccuracyPipe> pipes;
  for (const AccuracyRow& row : rows) pipes.push_back(row.measured.pipe);
  const std::vector<PipeFigures> figures = figures_of(pipes, o.operators);
  const Target target = parse_target(o.target);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].cost = cost_of(pipes[i], figures[i], target, table);
    if (o.check == 0 || pipes[i].variant != Variant::kCard) continue;
    for (const Arithmetic arithmetic : {Arithmetic::kHost, Arithmetic::kRtl})
      rows[i].simulated.push_back(simulated(pipes[i], arithmetic, o.seed, o.check));
  }
  return rows;
}

void run_pairs(const AccuracyOptions& o) {
  if (o.profile_cases > 0 && !o.json && o.page.empty())
    throw_usage("--profiles needs --page or --json");
  const SweepOptions options{.pipes = pipes_of(o),
                             .families = families_of(o),
                             .seed = o.seed,
                             .cases = o.cases,
                             .distribution = o.distribution,
                             .quiet = o.quiet};
  check_families(o, options.pipes);
  std::optional<OutputFile> page;
  if (!o.page.empty() && WorkDistributor::instance().leads()) page.emplace(o.page);
  Json all = head_json(kSweepSchema);
  say_what(o, all["machine"], counted(o.cases, "case") + " per line");
  const std::optional<std::vector<AccuracyRow>> measured = measured_rows(o, options);
  if (!measured) return;
  const std::vector<AccuracyRow>& rows = *measured;
  all.update({{"seed", o.seed},
              {"cases", o.cases},
              {"only_families", families_of(o)},
              {"band_u", 16},
              {"lanes", 1},
              {"profiles", Json::array()},
              {"configurations", accuracy_json(rows)}});
  if (o.profile_cases > 0)
    all["profiles"] = profiles_json(profiles(options.pipes, o.seed, o.profile_cases, o.quiet));
  if (page) write_page(*page, o, all, "this sweep");
  if (o.json)
    write(o, o.short_json ? short_json(all) : json_text(all) + "\n");
  else if (o.promises)
    write(o, promise_table(rows));
  else if (o.page != "-" || !o.output.empty())
    write(o, accuracy_tables(rows, o.by_family, o.markdown));
}

/// Makes the page of a saved sweep.
void run_kept(const AccuracyOptions& o) {
  if (o.page.empty())
    throw Error(ErrorCode::kUsage,
                "--from makes a page from the JSON of an earlier run; --page FILE is missing");
  OutputFile page(o.page);
  write_page(page, o, read_sweep(o.from, parse_target(o.target)).json, printable_name(o.from));
}

void run_picture(const AccuracyOptions& o) {
  AccuracyOptions of = o;
  of.pairs = {std::string(name(Pair::kRayTriangle))};
  const std::vector<AccuracyPipe> pipes = pipes_of(of);
  const Resolution size = parse_resolution(o.grid, "--grid");
  const Mesh mesh = load_mesh_or_builtin(o.mesh);
  warn(mesh.warnings);
  const Eigen::AlignedBox3f box = bounds(mesh);
  const std::vector<Ray> rays = o.camera.empty()     ? grid_rays(box, size)
                                : o.camera == "auto" ? camera_for(box, size).rays(size)
                                                     : parse_camera(o.camera).rays(size);
  Json all = head_json("cde.accuracy.picture.1");
  say_what(o, all["machine"],
           fmt::format("{}, {}, {}", printable_name(o.mesh), counted(mesh.faces.size(), "triangle"),
                       counted(rays.size(), "ray")));
  std::optional<OutputFile> page;
  if (!o.page.empty()) {
    need_three("--page");
    page.emplace(o.page);
  }
  const std::vector<PictureAccuracy> rows = picture_accuracy(mesh, rays, pipes, o.quiet);
  if (page) {
    page->write(pictures_html(rows, size, o.mesh, mesh));
    page->commit();
    if (!o.quiet) log("page: {}\n", printable_name(o.page));
    if (o.page == "-" && o.output.empty()) return;
  }
  if (o.json) {
    all.update({{"mesh", o.mesh}, {"band_u", 16}, {"pictures", picture_json(rows)}});
    write(o, json_text(all) + "\n");
  } else {
    write(o, picture_table(rows, o.markdown));
  }
}

/// Runs the queries of every frame in each format. Modelled times are for the planned card.
void run_scene(const AccuracyOptions& o) {
  cde::Scene scene = read_scene(o.scene, o.quiet);
  use_device(o.device, scene);
  scene.card.bvh = UseBvh::kOff;  // a BVH needs fp32, and the rows are for brute force
  const Plan planned = plan(scene);
  scene.card.device = device_for(scene.card.device, planned.board);
  const Frames frames = frames_of(o.frames, scene);
  SceneAccuracyOptions options{.first = frames.first, .last = frames.last, .quiet = o.quiet};
  for (const std::string& word : pair_formats())
    if (wanted(o.formats, word)) options.formats.push_back(FpFormat::parse(word));
  Json all = head_json("cde.accuracy.scene.1");
  say_what(o, all["machine"],
           fmt::format("{}, frames {}..{}", printable_name(o.scene), frames.first, frames.last));
  const std::vector<SceneAccuracy> rows = scene_accuracy(scene, planned, options);
  const Device& device = scene.card.device;
  const double clock_hz = device.clock_hz(),
               row_hz = clock_hz / std::max(1u, planned.board.shared_lane);
  if (o.json) {
    all.update({{"scene", o.scene},
                {"device", device_json(device)},
                {"clock_hz", clock_hz},
                {"lanes", planned.board.lanes},
                {"scene_rows", scene_accuracy_json(rows, row_hz)}});
    write(o, json_text(all) + "\n");
  } else {
    write(o, scene_table(rows, row_hz, o.markdown) +
                 fmt::format("rows ms: modelled time of only the rows, {} of {} in every "
                             "format, without start, write-back and bus\n",
                             counted(planned.board.lanes, "lane"), device.text()));
  }
}

/// Whether a format can run in front of fp32.
bool can_be_narrow(FpFormat format) {
  const FpFormat wide;
  return format.exp_bits <= wide.exp_bits && format.man_bits < wide.man_bits;
}

/// Rows of the certified filter, for the pairs that have it, with the fewest iterations unless
/// --iterations is given.
std::vector<FilterRow> filter_rows(const AccuracyOptions& o) {
  AccuracyOptions of = o;
  if (of.formats.empty()) of.formats = {"bf16", "fp16"};
  if (of.iterations.empty() && std::ranges::any_of(pair_names(), [&](const std::string& pair) {
        return wanted(o.pairs, pair) && has_iterations(*pair_named(pair));
      }))
    of.iterations = {"4,2,2"};
  std::vector<FilterRow> rows;
  for (const AccuracyPipe& pipe : card_pipes(of)) {
    if (!can_be_narrow(pipe.format))
      throw Error(ErrorCode::kUsage,
                  fmt::format("--filters: {} is not possible; expected a format with no more "
                              "exponent bits and fewer fraction bits than fp32",
                              pipe.format.name()));
    if (!has_proofs(pipe.pair)) {
      if (o.pairs.empty()) continue;
      throw Error(
          ErrorCode::kUsage,
          fmt::format("--filters: {} is not possible; expected pairs of solids without a plane",
                      name(pipe.pair)));
    }
    rows.push_back({pipe.pair, pipe.format, pipe.iterations, {}});
  }
  return rows;
}

void run_filters(const AccuracyOptions& o) {
  std::vector<FilterRow> rows = filter_rows(o);
  std::vector<AccuracyPipe> pipes;
  for (const FilterRow& row : rows) pipes.push_back({.pair = row.pair, .format = row.narrow});
  check_families(o, pipes);
  Json all = head_json("cde.accuracy.filters.1");
  say_what(o, all["machine"], counted(o.cases, "case") + " per line");
  measure_filters(rows, {families_of(o), o.seed, o.cases, o.quiet});
  if (o.json) {
    all.update({{"seed", o.seed}, {"cases", o.cases}, {"filters", filter_json(rows)}});
    write(o, json_text(all) + "\n");
  } else {
    write(o, filter_table(rows, o.by_family, o.markdown));
  }
}

/// A kind of work: the option that selects it, and the options that it uses. Others are refused.
struct Work {
  const char* option;
  std::vector<std::string_view> takes;
};
const Work kWorks[] = {
    {"--from", {"--page", "--target"}},
    {"--filters",
     {"--pair", "--formats", "--iterations", "--families", "--cases", "--seed", "--by-family",
      "--json", "--markdown", "--output"}},
    {"--scene", {"--formats", "--frames", "--device", "--json", "--markdown", "--output"}},
    {"--mesh",
     {"--pair", "--formats", "--algorithms", "--box", "--variants", "--grid", "--camera", "--page",
      "--json", "--markdown", "--output"}}};

void check_options(const CLI::App& verb, const AccuracyOptions& o) {
  for (const Work& work : kWorks) {
    if (verb.count(work.option) == 0) continue;
    if (WorkDistributor::instance().ranks() > 1)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} works only in one process, but {} ranks were started",
                              work.option, WorkDistributor::instance().ranks()));
    for (const CLI::Option* given : verb.get_options()) {
      const std::string option = given->get_name();
      if (given->count() > 0 && option != work.option && option != "--quiet" &&
          std::ranges::find(work.takes, option) == work.takes.end())
        cannot_combine(option, work.option);
    }
    if (work.option == std::string_view("--mesh") &&
        std::ranges::any_of(
            o.pairs, [](const std::string& pair) { return pair != name(Pair::kRayTriangle); }))
      cannot_combine("--mesh", fmt::format("--pair {}", fmt::join(o.pairs, ",")),
                     "expected ray-triangle");
    return;
  }
}

/// Refuses options that have no effect on a sweep.
void check_sweep_options(const CLI::App& verb, const AccuracyOptions& o) {
  if (!wanted(o.pairs, name(Pair::kRayTriangle)))
    for (const char* option : {"--algorithms", "--box", "--profiles"})
      if (verb.count(option) > 0)
        cannot_combine(option, fmt::format("--pair {}", fmt::join(o.pairs, ",")),
                       "expected ray-triangle among them");
  if (o.by_family && o.promises) cannot_combine("--by-family", "--promises");
  if (o.by_family && o.json)
    cannot_combine("--by-family", "--json", "JSON has all families unless --short is given");
  if (verb.count("--target") > 0 && o.promises && o.page.empty())
    cannot_combine("--target", "--promises");
}

void run(const CLI::App& verb, const AccuracyOptions& o) {
  check_options(verb, o);
  check_sweep_options(verb, o);
  const char* prints = o.json       ? "--json"
                       : o.promises ? "--promises"
                                    : nullptr;  // in addition to a page
  const bool to_stdout = prints != nullptr && o.output.empty();
  std::vector<FileUse> inputs = {{"--from", o.from}};
  WorkDistributor::instance().add_inputs(inputs);
  check_outputs(
      std::vector<FileUse>{to_stdout ? FileUse{prints, "-"} : FileUse{"--output", o.output},
                           {"--resume", o.distribution.resume},
                           {"--page", o.page}},
      inputs);
  check_suffix("--page", o.page, ".html");
  if (!o.from.empty())
    run_kept(o);
  else if (o.filters)
    run_filters(o);
  else if (!o.scene.empty())
    run_scene(o);
  else if (o.mesh.empty())
    run_pairs(o);
  else
    run_picture(o);
}

CLI::Option* list(CLI::Option* option, char between = ',') {
  return option->delimiter(between)->allow_extra_args(false);
}

void add_choices(CLI::App& verb, AccuracyOptions& o) {
  begin_group(verb, "Pipes");
  pair_value(
      list(verb.add_option("--pair", o.pairs, "Pairs, separated by commas")->default_str("all")),
      "LIST");
  named(list(verb.add_option("--formats", o.formats, "Number formats")->default_str("all")),
        pair_formats(), "LIST", "format");
  named(list(verb.add_option("--algorithms", o.algorithms, "Algorithms of ray-triangle")
                 ->default_str("all")),
        algorithm_names(), "LIST", "algorithm");
  one_of(verb.add_option("--box", o.box, "ray-triangle with the box rule, without it, or both")
             ->capture_default_str(),
         {"both", "on", "off"});
  known_words(list(verb.add_option("--iterations", o.iterations,
                                   "Iterations of cylinder pairs, as in cde query --iterations, "
                                   "separated by colons: 4,0,0:8,8,8")
                       ->default_str("8,8,8"),
                   ':'),
              {}, "LIST");
  named(list(verb.add_option("--variants", o.variants,
                             "Variants to measure: card is the card's pipe. The others exist in no "
                             "card: fused rounds each multiply-add once, textbook uses the usual "
                             "quadratics and separating axes")
                 ->capture_default_str()),
        {"card", "fused", "textbook"}, "LIST", "variant");
}

void add_cases(CLI::App& verb, AccuracyOptions& o) {
  begin_group(verb, "Cases");
  known_words(list(verb.add_option("--families", o.families,
                                   "Families of cases; an unknown name lists them")
                       ->default_str("all")),
              {}, "LIST");
  whole_number_in(verb.add_option("--cases", o.cases, "Cases per pipe, shared among its families")
                      ->capture_default_str(),
                  1, 100'000'000, "");
  whole_number_in(verb.add_option("--seed", o.seed, "Seed of the cases")->capture_default_str(), 0,
                  1'000'000'000'000, "");
  whole_number_in(verb.add_option("--check", o.check,
                                  "Cases that also run through the simulated pipe, with host "
                                  "arithmetic and with gates; the models are built first")
                      ->capture_default_str(),
                  0, 1'000'000, "");
  add_distribution_options(verb, o.distribution);
}

/// Adds the options that measure something other than generated cases.
void add_works(CLI::App& verb, AccuracyOptions& o) {
  begin_group(verb, "Instead of generated cases");
  auto* mesh = file_value(
      verb.add_option("--mesh", o.mesh,
                      "Measure a picture of this mesh: a file, terrain or terrain:X,Y,SEED"),
      "MESH");
  text_value(verb.add_option("--grid", o.grid, "Rays of the picture")->capture_default_str(), "WxH",
             [](const std::string& text) { (void)parse_resolution(text, "--grid"); })
      ->needs(mesh);
  known_words(verb.add_option("--camera", o.camera,
                              "Rays of a camera, eye,target[,angle], not straight down"),
              {"auto"}, "EX,EY,EZ,TX,TY,TZ[,FOV]|auto")
      ->needs(mesh);
  auto* scene =
      file_value(verb.add_option("--scene", o.scene,
                                 "Compare the records of this scene with fp64, frame by frame"),
                 "SCENE");
  scene->excludes(mesh);
  frames_option(verb, o.frames)->needs(scene);
  scene_device_option(verb, o.device)->needs(scene);
}

void add_page(CLI::App& verb, AccuracyOptions& o) {
  begin_group(verb, "Page and costs");
  auto* page = file_value(verb.add_option("--page", o.page,
                                          "Also write all figures as a page with charts, one HTML "
                                          "file that loads nothing (- is stdout)"),
                          "FILE.html");
  file_value(
      verb.add_option("--from", o.from, "Make the page from a file of --json; nothing is measured")
          ->needs(page),
      "FILE");
  whole_number_in(verb.add_option("--profiles", o.profile_cases,
                                  "Rays per point in charts of ray-triangle's error against "
                                  "grazing angle, size, distance and aspect; 0: no charts")
                      ->capture_default_str(),
                  0, 1'000'000, "");
  target_option(verb, o.target, "FPGA of the costs per lane, or an assumed clock")
      ->capture_default_str();
  verb.add_flag("--operators,!--no-operators", o.operators,
                "Count operators and cycles in the RTL; the first time this takes seconds per pipe")
      ->default_str("on");
}

void add_output(CLI::App& verb, AccuracyOptions& o) {
  begin_group(verb, "Output");
  file_value(
      verb.add_option("-o,--output", o.output, "File for the figures")->default_str("stdout"),
      "FILE");
  auto* json = verb.add_flag("--json", o.json, "All figures as JSON");
  verb.add_flag("--short", o.short_json, "JSON without the families, one line per configuration")
      ->needs(json);
  auto* markdown = verb.add_flag("--markdown", o.markdown, "Tables in Markdown")->excludes(json);
  verb.add_flag("--by-family", o.by_family, "Also print a line per family");
  verb.add_flag("--promises", o.promises,
                "Print only a table in Markdown: the promise of each pipe, whether it was kept, "
                "and the excused cases")
      ->excludes(json)
      ->excludes(markdown)
      ->excludes("--filters");
  verb.add_flag("-q,--quiet", o.quiet, "No progress");
}

/// Called after the options that it excludes are added.
void add_filters(CLI::App& verb, AccuracyOptions& o) {
  begin_group(verb, "Instead of generated cases");
  CLI::Option* filters = verb.add_flag(
      "--filters", o.filters,
      "Measure the certified filter of pairs of solids: how many misses of a narrow format are "
      "proved in fp32. Default of --formats is bf16,fp16, of --iterations 4,2,2");
  for (const char* other :
       {"--mesh", "--scene", "--page", "--from", "--resume", "--shard", "--check", "--variants"})
    filters->excludes(other);
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto o = std::make_shared<AccuracyOptions>();
  CLI::App* verb = app.add_subcommand(
      "accuracy",
      "Measure how far pipes are from the exact result, and what they cost. Each case runs through "
      "the mirror reference, which equals the card bit by bit, and is compared with exact or "
      "certified arithmetic. With --mesh the cases are the pixels of a picture");
  add_choices(*verb, *o);
  add_cases(*verb, *o);
  add_works(*verb, *o);
  add_page(*verb, *o);
  add_filters(*verb, *o);
  add_output(*verb, *o);
  verb->callback([o, verb] {
    normalise_pairs(o->pairs);
    run(*verb, *o);
  });
}

}  // namespace cde::cli
