// SPDX-License-Identifier: Apache-2.0
// cde cast: rays against a mesh on the simulated card, every record checked against the reference.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/contract/records.hpp"
#include "cde/image/rays_csv.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "command/values.hpp"
#include "command/words.hpp"
#include "output/busy.hpp"
#include "output/json_keys.hpp"
#include "output/npy.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "output/suffix.hpp"
#include "verbs/cast.hpp"
#include "verbs/cast_picture.hpp"
#include "verbs/plan_output.hpp"
#include "verbs/record_file.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

constexpr std::uint64_t kPacket = card::kMostPrimaries;

[[noreturn]] void usage(const std::string& message) {
  throw Error(ErrorCode::kUsage, message);
}

std::vector<Ray> read_rays(const std::string& path) {
  if (path == "-") {
    // An array begins with a byte that no text does.
    if (std::cin.peek() == kNpyFirstByte) return read_rays_npy(std::cin, "stdin");
    return read_rays_csv(std::cin, "stdin");
  }
  if (std::filesystem::path(path).extension() != ".npy") return read_rays_csv(path);
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw Error(ErrorCode::kFile, fmt::format("{}: cannot be opened: {}", printable_name(path),
                                              std::strerror(errno)));
  return read_rays_npy(in, printable_name(path));
}

void collect_rays(const CastOptions& o, CastJob& job) {
  const bool listed = !o.rays_file.empty() || !o.rays.empty();
  if (listed + !o.camera.empty() + !o.grid.empty() > 1)
    usage("--rays or --ray, --camera and --grid exclude each other");
  if (!listed) return aim(o, job);
  if (!o.size.empty()) usage("--size is of pictures; the rays are given one by one");
  if (!o.rays_file.empty()) job.listed = read_rays(o.rays_file);
  for (const std::string& text : o.rays)
    job.listed.push_back(parse_ray(text, "--ray " + printable_name(text)));
  job.rays = job.listed;
  if (job.rays.empty())
    throw Error(
        ErrorCode::kBadInput,
        fmt::format("{}: no rays", o.rays_file == "-" ? "stdin" : printable_name(o.rays_file)));
}

/// Wide cards simulate nearly twice as many tests a second (217 M instead of 117 M on one core),
/// but their gates take minutes to compile, their waves are four times as large, and a few rays do
/// not fill them.
unsigned lanes_of(const CastOptions& o, std::size_t rays) {
  if (o.lanes != "auto") return static_cast<unsigned>(std::stoul(o.lanes));
  return o.arithmetic == "host" && !o.trace.wanted() && rays > 16 ? 64 : 16;
}

/// A card that is built instead of one that is not, where what that costs is less than what
/// building takes: at most 0.3 times a minute or so of simulation.
void use_built_card(const CastOptions& o, CastJob& job) {
  constexpr double kMostTests = 1e10;
  const std::uint64_t rays = job.rays.size(), triangles = job.triangles;
  if (o.exact || static_cast<double>(rays) * static_cast<double>(triangles) > kMostTests) return;
  SceneCard asked;
  if (o.lanes != "auto") asked.lanes = job.config.lanes;
  const auto card = built_card(job.config, asked, [&](unsigned lanes) {
    return ((rays / kPacket) * (kPacket / lanes) + (rays % kPacket + lanes - 1) / lanes) *
           triangles;
  });
  if (!card) return;
  job.stands_in_for = {job.config, card->times};
  job.config = card->board;
  if (!o.quiet) say("cde: {}\n", stand_in_text(job.config, *job.stands_in_for));
}

/// `more` are files that the mesh names.
void check_files(const CastOptions& o, const std::vector<std::filesystem::path>& more = {}) {
  std::vector<FileUse> inputs = {{"MESH", o.mesh}, {"--rays", o.rays_file}};
  for (const auto& file : more) inputs.push_back({"MESH", file});
  check_outputs(
      std::vector<FileUse>{
          {"-o", o.records},
          {"--image", o.depth},
          {"--shaded", o.shaded.empty() && o.shows_itself ? own_picture_name(o.mesh) : o.shaded},
          {"--normals", o.normals},
          {"--indices", o.indices},
          {"--trace", o.trace.file},
          {"--resume", o.deal.resume},
          {"--json", o.json ? "-" : ""}},
      inputs);
}

/// N of --check=rays:N.
std::uint64_t swept_rays(const std::string& text) {
  constexpr std::string_view kRays = "rays:";
  const char* const end = text.data() + text.size();
  std::uint64_t rays = 0;
  if (text.starts_with(kRays)) {
    const auto [stop, error] = std::from_chars(text.data() + kRays.size(), end, rays);
    if (error == std::errc() && stop == end) return rays;
  }
  usage(fmt::format("--check is '{}'; it must be rays:N, a number of rays, or nothing",
                    printable_name(text)));
}

/// What --check says.
void settle_checks(CastOptions& o) {
  o.check = o.checks != "false";
  if (o.check && o.checks != "true") o.swept_rays = swept_rays(o.checks);
}

/// All that can be said to be wrong without a mesh.
void check_options(const CastOptions& o, Mode mode) {
  check_files(o);
  if (o.trace.wanted() && o.boards > 1) usage("--trace follows one card; leave out --boards");
  if (mode == Mode::kOccluded && !o.fields.empty())
    usage("--fields are of triangles, and mode occluded does not say which one it is");
  if (o.wants_picture() && mode != Mode::kNearest) usage("a picture needs --mode nearest");
  if (o.shadows && o.shaded.empty() && !o.shows_itself) usage("--shadows is of --shaded");
  o.trace.check();
  check_picture_names(o);
  RecordFile::check(o.records, o.bits, o.fields);
}

/// Meshes and rays of fp32 files may have what the card flags; what another format makes of them is
/// an error before anything runs.
void check_mesh(const Mesh& mesh, const std::string& what, FpFormat format) {
  const auto why = out_of_range(mesh, what, format);
  if (why && format != FpFormat{}) throw Error(ErrorCode::kBadInput, *why);
  if (why) say("cde: warning: {}\n", *why);
}
void check_rays(const CastJob& job) {
  if (job.config.format == FpFormat{}) return;
  for (std::size_t i = 0; i < job.rays.size(); ++i)
    if (const auto why = defect(job.rays[i], job.config.format))
      throw Error(ErrorCode::kBadInput, fmt::format("ray {}: {}", i, *why));
}

/// Why rays do not go through a hierarchy; nothing if they can.
std::optional<std::string> no_way_through(const CastOptions& o, const CastJob& job) {
  if (job.mode == Mode::kAll) return "mode all has records of all triangles, hit or not";
  if (!job.config.box) return "without the box rule no tree answers as all triangles do";
  if (job.config.format != FpFormat{})
    return fmt::format("boxes are widened by 2^-16 of the scene, percents of it in {}", o.format);
  if (o.partition > 1) return "parts of a mesh are swept";
  return std::nullopt;
}

/// From so many triangles on a hierarchy wins, of many rays.
constexpr std::uint64_t kWorthATree = 2048;

/// Whether building it, a microsecond a triangle, and simulating 4 a ray takes less than a sweep of
/// 64 lanes, 4.6 ns a test (cde bench).
bool pays(std::uint64_t triangles, std::uint64_t rays) {
  const auto t = static_cast<double>(triangles), r = static_cast<double>(rays);
  return t + 4 * r < 4.6e-3 * t * r;
}

/// Whether the tree as it is still wins: boxes that overlap leave little out. A clock takes 0.4 us
/// to simulate, of a node in one of two units or of a triangle.
bool pays(const CastJob& job) {
  const Hierarchy::Visits visits = job.hierarchy->expected_visits();
  const double a_ray = 2 + 0.4 * std::max(visits.nodes / 2, visits.secondaries);
  return a_ray < 4.6e-3 * static_cast<double>(job.triangles);
}

/// Whether rays go through a hierarchy, as far as that can be said without one.
bool takes_hierarchy(const CastOptions& o, CastJob& job) {
  const auto why_not = no_way_through(o, job);
  if (job.mode == Mode::kOccluded && (why_not || o.bvh < 0))
    usage("mode occluded is of a hierarchy: " + why_not.value_or("not with --no-bvh"));
  if (o.bvh > 0 && why_not) usage("--bvh: " + *why_not);
  const bool wanted = o.bvh > 0 || job.mode == Mode::kOccluded ||
                      (o.bvh == 0 && o.lanes == "auto" && job.triangles >= kWorthATree);
  return wanted && !why_not;
}

/// Without a hierarchy, whose picture would have been larger.
void sweep_instead(const CastOptions& o, CastJob& job) {
  job.hierarchy = nullptr;
  job.config.node_units = 0;
  if (job.picture && o.size.empty()) aim(o, job);
}

/// The tree, and a card with memory for it.
void grow_hierarchy(const CastOptions& o, CastJob& job) {
  try {
    const Busy busy("building a hierarchy", o.quiet);
    job.hierarchy = std::make_shared<const Hierarchy>(Hierarchy::build(job.mesh));
  } catch (const Error& e) {
    if (o.bvh > 0 || job.mode == Mode::kOccluded)
      throw Error(e.code(), fmt::format("{}: no hierarchy: {}", printable_name(o.mesh), e.what()));
    say("cde: warning: {}: {}; all triangles are swept\n", printable_name(o.mesh), e.what());
    return sweep_instead(o, job);
  }
  if (o.bvh == 0 && job.mode != Mode::kOccluded && !pays(job)) return sweep_instead(o, job);
  const auto needed =
      std::max<std::uint64_t>({job.config.nodes, std::bit_ceil(job.hierarchy->nodes().size()),
                               std::bit_ceil((job.triangles + 7) / 8)});
  job.config.nodes = static_cast<unsigned>(needed);
  // What sweeps has nothing to do.
  if (o.lanes == "auto") job.config.lanes = 4;
}

CastJob prepare(const CastOptions& o) {
  CastJob job;
  job.mode = *mode_named(o.mode);
  check_options(o, job.mode);
  job.config.arithmetic = o.arithmetic == "rtl" ? Arithmetic::kRtl : Arithmetic::kHost;
  job.config.algorithm = *algorithm_named(o.algorithm);
  job.config.box = o.box;
  job.config.format = FpFormat::parse(o.format);
  job.config.trace = o.trace.wanted();
  {
    const Busy busy("loading " + printable_name(o.mesh), o.quiet);
    job.mesh = load_mesh_or_builtin(o.mesh);
  }
  job.triangles = job.mesh.faces.size();
  check_files(o, job.mesh.files);
  check_mesh(job.mesh, printable_name(o.mesh), job.config.format);
  job.config.node_units = takes_hierarchy(o, job) ? 2 : 0;
  collect_rays(o, job);
  check_rays(job);
  if (o.bvh == 0 && job.mode != Mode::kOccluded && !pays(job.triangles, job.rays.size()))
    job.config.node_units = 0;
  job.config.lanes = lanes_of(o, job.rays.size());
  if (o.wants_picture() && !job.picture) usage("a picture needs --camera or --grid");
  if (o.partition > job.triangles)
    usage(fmt::format("--partition {}: {} has {} triangles", o.partition, printable_name(o.mesh),
                      job.triangles));
  if (job.triangles > std::uint64_t{o.partition} * job.config.ddr_slots) {
    throw Error(ErrorCode::kCapacity,
                fmt::format("{}: {} triangles do not fit the card's DDR, which holds {}; "
                            "--partition shares them out to several cards",
                            printable_name(o.mesh), job.triangles, job.config.ddr_slots));
  }
  if (job.config.node_units != 0) grow_hierarchy(o, job);
  if (!job.hierarchy) use_built_card(o, job);
  return job;
}

/// Records that come of the job, where the mode says so.
std::optional<std::uint64_t> records_of(const CastJob& job) {
  if (job.mode == Mode::kHits) return std::nullopt;
  return job.rays.size() * (job.mode == Mode::kAll ? job.triangles : 1);
}

/// The second pass of a picture, to the sun. Its clocks and records are counted with the first.
void cast_shadows(const CastOptions& o, CastPicture& picture, CastOutcome& all) {
  picture.look_at_sun([&](const CastJob& job, const RecordSink& take) {
    const CastOutcome sun = cast_rays(o, job, "casting shadows", take);
    all.counters += sun.counters;
    all.compared += sun.compared;
    all.matching += sun.matching;
    all.modelled_seconds += sun.modelled_seconds;
    all.simulation_seconds += sun.simulation_seconds;
    if (all.difference.empty()) all.difference = sun.difference;
  });
}

/// Cards that share the work: of this process, of the ranks, or of the parts of the mesh.
unsigned cards_of(const CastOptions& o) {
  return o.partition > 1 ? o.partition : std::max(o.boards, Dealing::here().ranks());
}

/// Whether modelled times have records of several cards come over a network.
bool has_network(const CastOptions& o) {
  return std::max(o.partition, Dealing::here().ranks()) > 1;
}

std::size_t packets_of(const CastJob& job) {
  return (job.rays.size() + kPacket - 1) / kPacket;
}

nlohmann::ordered_json as_json(const CastOptions& o, const CastJob& job, const CastOutcome& r) {
  nlohmann::ordered_json j = program_json();
  j.update({{"mesh", o.mesh},
            {"triangles", job.triangles},
            {"rays", job.rays.size()},
            {"packets", packets_of(job)},
            {"mode", o.mode},
            {"boards", cards_of(o)},
            {"partition", o.partition},
            {"network", has_network(o) ? nlohmann::ordered_json(kNetwork) : nullptr}});
  j.update(card_json(job.config));
  j.update(bitstream_json(r.bitstream, r.config_hash));
  j.update(stand_in_json(job.stands_in_for));
  j.update({{"clock_hz", o.clock.mhz * 1e6},
            {"clock_is", o.clock_is},
            {"modelled_pass_seconds", r.modelled_seconds}});
  j.update(counters_json(r.counters));
  j.update(
      {{"secondary_upload_clocks", r.upload_clocks},
       {"primary_upload_clocks", r.counters.upload_clocks},
       {"total_clocks", r.counters.total_clocks},
       {"simulation_seconds", r.simulation_seconds},
       {"tests_per_second_simulated", static_cast<double>(r.counters.pairs) / r.simulation_seconds},
       {"hits", r.hits},
       {"records", r.counters.records},
       {"records_compared", r.compared},
       {"records_matching", r.matching},
       {"mismatches", r.compared - r.matching},
       {"through", job.hierarchy ? "hierarchy" : "sweep"},
       {"swept_rays", r.swept_rays},
       {"checked", o.check}});
  return j;
}

void print_summary(const CastOptions& o, const CastJob& job, const CastOutcome& r) {
  const Counters& c = r.counters;
  // With those of shadows.
  const std::uint64_t rays = job.mode == Mode::kHits ? job.rays.size() : c.records;
  const auto row = [](const char* name, const std::string& value) {
    say("{:<16} {}\n", name, value);
  };
  row("mesh", fmt::format("{}, {} triangles", printable_name(o.mesh), job.triangles));
  row("rays", fmt::format("{} in {} packet{}", job.rays.size(), packets_of(job),
                          packets_of(job) == 1 ? "" : "s"));
  const unsigned cards = cards_of(o);
  row(cards == 1 ? "card" : "cards",
      fmt::format("{}{} lanes, {} arithmetic, {}, {}{}, mode {}",
                  cards == 1 ? "" : fmt::format("{} x ", cards), job.config.lanes, o.arithmetic,
                  job.config.format.name(), o.algorithm == "moller" ? "" : o.algorithm + ", ",
                  o.box ? "box rule" : "no box rule", o.mode));
  if (job.hierarchy) {
    const auto a_ray = [&](std::uint64_t n) {
      return static_cast<double>(n) / static_cast<double>(rays);
    };
    row("hierarchy",
        fmt::format("{} node{}, {} level{}, {} node units; a ray reads {:.1f} and meets "
                    "{:.1f} triangles",
                    job.hierarchy->nodes().size(), job.hierarchy->nodes().size() == 1 ? "" : "s",
                    job.hierarchy->depth(), job.hierarchy->depth() == 1 ? "" : "s",
                    job.config.node_units, a_ray(c.nodes), a_ray(c.pairs)));
  }
  row("device cycles", fmt::format("{} and {} of write-back, {} stalls, {} bubbles", c.cycles,
                                   c.writeback, c.stalls, c.bubbles));
  row("modelled time",
      fmt::format("{:.6g} ms at {:g} MHz{}, without bus transfers{}", 1e3 * r.modelled_seconds,
                  o.clock.mhz, o.clock.target.empty() ? "" : " " + o.clock_is,
                  has_network(o) ? std::string(", ") + kNetwork : ""));
  row("simulation", job.hierarchy
                        ? fmt::format("{:.3g} s, {:.4g} M rays/s", r.simulation_seconds,
                                      static_cast<double>(rays) / r.simulation_seconds / 1e6)
                        : fmt::format("{:.3g} s, {:.4g} M tests/s", r.simulation_seconds,
                                      static_cast<double>(c.pairs) / r.simulation_seconds / 1e6));
  row("hits", fmt::format("{} in {} records", r.hits, c.records));
  row("check",
      o.check ? fmt::format("{} of {} records match the reference{}", r.matching, r.compared,
                            job.hierarchy ? fmt::format("; {} of the rays met all triangles, too",
                                                        r.swept_rays)
                                          : "")
              : "off");
}

void run(const CastOptions& asked) {
  CastOptions o = asked;
  settle_checks(o);
  CastJob job;
  if (Dealing::here().leads())
    job = prepare(o);
  else
    job.mode = *mode_named(o.mode);
  share_job(o, job);
  o.clock_is = settle_clock(o.clock, job.config);
  begin_dealt(o, job);
  if (!Dealing::here().leads() || Dealing::here().is_shard()) {
    (void)cast_rays(o, job, "casting", [](std::span<const Record>) {});
    return;
  }
  std::optional<CastPicture> picture;
  if (o.makes_picture()) picture.emplace(o, job);
  std::optional<RecordFile> records;
  if (!o.records.empty())
    records.emplace(o.records, o.bits, o.fields, job.mesh, job.rays, records_of(job));
  CastOutcome result = cast_rays(o, job, "casting", [&](std::span<const Record> some) {
    if (records) records->add(some);
    if (picture) picture->add(some);
  });
  if (picture && result.difference.empty()) cast_shadows(o, *picture, result);
  if (result.difference.empty()) {  // wrong records leave neither files nor pictures
    if (picture) picture->write();
    if (records) records->commit();
  }
  if (o.json) put_json(as_json(o, job, result));
  if (!o.quiet) print_summary(o, job, result);
  if (result.difference.empty()) return;
  const auto fill = [&](Bundle& bundle) { bundle_cast(bundle, o, job, result); };
  throw Error(ErrorCode::kMismatch, result.difference + packed(o.bundle, o.quiet, fill));
}

void add_sources(CLI::App& verb, CastOptions& o) {
  file_value(verb.add_option("mesh", o.mesh, "Mesh file, or terrain[:QX,QY,SEED]")->required(),
             "MESH");
  file_value(verb.add_option("--rays", o.rays_file,
                             "Rays from a file (- is stdin, either form): CSV, "
                             "ox,oy,oz,dx,dy,dz[,tmin[,tmax]] a line or in "
                             "the order of a header with these names; or .npy, N x 6, 7 or 8 "
                             "numbers"),
             "FILE");
  text_value(
      verb.add_option("--ray", o.rays, "One ray, same fields; repeatable")->allow_extra_args(false),
      "RAY",
      [](const std::string& text) { (void)parse_ray(text, "--ray " + printable_name(text)); });
  text_value(verb.add_option("--camera", o.camera,
                             "Picture: ex,ey,ez,tx,ty,tz[,fov]: eye, target, vertical field of "
                             "view, above 0 and below 180 degrees (40); without it one that shows "
                             "the mesh"),
             "VIEW", [](const std::string& text) { (void)parse_camera(text, "--camera"); });
  text_value(verb.add_option("--grid", o.grid, "Picture straight down, of square pixels"), "WxH",
             [](const std::string& text) { (void)parse_resolution(text, "--grid"); });
  text_value(verb.add_option("--size", o.size,
                             "Size of a picture; 640x480 if not given, or without a hierarchy "
                             "the smaller the more triangles, down to 128x96"),
             "WxH", [](const std::string& text) { (void)parse_resolution(text, "--size"); });
  one_of(verb.add_option("--up", o.up, "Axis that is up in pictures; many formats have y")
             ->capture_default_str(),
         {"x", "y", "z"});
}

void add_outputs(CLI::App& verb, CastOptions& o) {
  file_value(verb.add_option("-o,--output", o.records,
                             "Records: ray,F,T,CPx,CPy,CPz,index as .csv (- is stdout, as CSV), "
                             ".npy or .jsonl; index is 4294967295 (null in .jsonl) without a hit"),
             "FILE");
  verb.add_flag("--bits", o.bits, "CSV also shows T and CP as hexadecimal bits");
  named(verb.add_option("--fields", o.fields,
                        "More of each record, separated by commas, computed by the host and "
                        "not by the card: u and v (barycentric), normal (of the triangle), "
                        "side (1 front, -1 back), node (of the mesh file)")
            ->delimiter(',')
            ->allow_extra_args(false),
        field_names(), "LIST", "field");
  file_value(verb.add_option("--shaded", o.shaded, "Picture in sunlight, .png"), "FILE");
  verb.add_flag("--shadows", o.shadows,
                "With --shaded: a second pass, from every hit to the sun, draws shadows");
  file_value(verb.add_option("--image", o.depth,
                             "Depths: .png (16 bits, near is bright), .pfm or .npy (T, inf is no "
                             "hit)"),
             "FILE");
  file_value(verb.add_option("--normals", o.normals, "Normals towards the eye: .png, .pfm or .npy"),
             "FILE");
  file_value(verb.add_option("--indices", o.indices,
                             "Numbers of triangles: .png (a colour each) "
                             "or .npy"),
             "FILE");
  add_bundle_options(verb, o.bundle);
  add_deal_options(verb, o.deal);
  add_trace_options(verb, o.trace,
                    "Waves of the cast, FST; kept even if the cast fails or is stopped");
  verb.add_flag("--json", o.json, "Summary as JSON on stdout");
  verb.add_flag("-q,--quiet", o.quiet, "No summary and no progress");
}

void add_card(CLI::App& verb, CastOptions& o) {
  one_of(verb.add_option("--mode", o.mode,
                         "Records to keep: one a ray, or all pairs, or all hits; occluded: whether "
                         "anything is hit, and no more, by a hierarchy")
             ->capture_default_str(),
         {"nearest", "farthest", "any", "all", "hits", "occluded"});
  one_of(verb.add_option("--algorithm", o.algorithm, "Test of a ray and a triangle")
             ->capture_default_str(),
         algorithm_names());
  one_of(verb.add_option("--format", o.format,
                         "Number format of the card, to which mesh and rays are rounded; a "
                         "coordinate that it has not is an error")
             ->capture_default_str(),
         card_formats());
  lanes_value(
      verb.add_option("--lanes", o.lanes,
                      "Pairs a clock of a sweep, a power of two to 256; auto is 64, but 16 with "
                      "rtl arithmetic, waves, or at most 16 rays")
          ->capture_default_str(),
      {"auto"});
  whole_number_in(
      verb.add_option("--boards", o.boards,
                      "Cards that share the rays, each simulated in a thread; clocks are summed")
          ->capture_default_str(),
      1, 64, "");
  whole_number_in(
      verb.add_option("--partition", o.partition,
                      "Parts of the mesh, each in the memory of a card of its own, "
                      "simulated by the rank that has it; records are those of one card")
          ->capture_default_str(),
      1, 1024, "");
  one_of(verb.add_option("--arith", o.arithmetic,
                         "The processor's arithmetic, fast, or gates; same bits, same clocks")
             ->capture_default_str(),
         {"host", "rtl"});
  verb.add_flag("--box,!--no-box", o.box,
                "A hit must lie in the triangle's box, so that none is far from its triangle (on)");
  verb.add_flag("--bvh,!--no-bvh", o.bvh,
                "Rays go through a hierarchy of boxes, or meet all triangles: the same records; "
                "by itself through one where that is sooner, of 2,048 triangles at least");
  flag_value(verb.add_flag("--check,!--no-check", o.checks,
                           "Compare every record with the reference (on); --check=rays:N: of rays "
                           "through a hierarchy N meet all triangles in the reference, too (64)"),
             [](const std::string& text) { (void)swept_rays(text); });
  exact_card_option(verb, o.exact);
  clock_options(verb, o.clock);
  deadline_options(verb, o.deadline, o.timeout, "packet");
}

}  // namespace

void add_cast(CLI::App& app) {
  auto o = std::make_shared<CastOptions>();
  CLI::App* verb = app.add_subcommand(
      "cast",
      "Cast rays at a mesh on the simulated card; without rays, a picture of the mesh. With "
      "nothing but the mesh, the picture is written as NAME.cast.png in this folder, and shown if "
      "stdout is a terminal");
  add_sources(*verb, *o);
  add_outputs(*verb, *o);
  add_card(*verb, *o);
  verb->callback([o] {
    tell_builds(!o->quiet);
    const bool rays = !o->rays.empty() || !o->rays_file.empty();
    o->shows_itself = !rays && o->mode == "nearest" && !o->wants_picture() && o->records.empty() &&
                      !o->trace.wanted() && !o->json;
    try {
      run(*o);
    } catch (const CastStopped&) {
      say("cde: stopped; {} has the waves until then\n", printable_name(o->trace.file));
      exit_code = 128 + Interrupts::signal();
    }
  });
}

}  // namespace cde::cli
