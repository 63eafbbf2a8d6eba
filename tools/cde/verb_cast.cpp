// cde cast: rays against a mesh on the simulated card, every record checked against the reference.
#include <fmt/format.h>

#include <bit>
#include <chrono>
#include <future>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/board.hpp"
#include "cde/camera.hpp"
#include "cde/error.hpp"
#include "cde/image.hpp"
#include "cde/mesh.hpp"
#include "cde/rays_csv.hpp"
#include "cde/reference.hpp"
#include "output.hpp"
#include "streams.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Options {
  std::string mesh, rays_file, camera, grid, size, csv, depth, shaded, trace;
  std::vector<std::string> rays;
  std::string mode = "nearest", arithmetic = "host";
  unsigned lanes = BoardConfig{}.lanes, boards = 1;
  double clock_mhz = 100, timeout = 3600;
  std::uint64_t deadline = 0;
  bool box = true, json = false, check = true, bits = false, quiet = false;
};

/// What is cast: rays, and the picture they make if they are one.
struct Job {
  Mesh mesh;
  std::vector<Ray> rays;
  std::optional<Resolution> picture;
  Mode mode = Mode::kNearest;
  BoardConfig config;
};

struct Outcome {
  Counters counters;
  std::uint64_t hits = 0, compared = 0, matching = 0, upload_clocks = 0;
  std::string difference;       // of the first record that does not match
  double modelled_seconds = 0;  // of the passes, on the card that takes longest
  double simulation_seconds = 0;
  std::string bitstream;
  std::uint64_t config_hash = 0;
  std::vector<Record> pixels;  // of a picture
};

[[noreturn]] void usage(const std::string& message) {
  throw Error(ErrorCode::kUsage, message);
}

void collect_rays(const Options& o, Job& job) {
  const bool listed = !o.rays_file.empty() || !o.rays.empty();
  if (listed + !o.camera.empty() + !o.grid.empty() > 1) {
    usage("--rays or --ray, --camera and --grid exclude each other");
  }
  if (listed) {
    if (!o.size.empty()) usage("--size is of pictures; the rays are given one by one");
    if (o.rays_file == "-")
      job.rays = read_rays_csv(std::cin, "stdin");
    else if (!o.rays_file.empty())
      job.rays = read_rays_csv(o.rays_file);
    for (const std::string& text : o.rays) job.rays.push_back(parse_ray(text));
    if (job.rays.empty())
      throw Error(ErrorCode::kBadInput, fmt::format("{}: no rays", o.rays_file));
    return;
  }
  const Eigen::AlignedBox3f box = bounds(job.mesh);
  if (!o.grid.empty()) {
    if (!o.size.empty()) usage("--grid has its own size; --size goes with --camera");
    job.picture = parse_resolution(o.grid, "--grid");
    job.rays = grid_rays(box, *job.picture);
    return;
  }
  job.picture = o.size.empty() ? Resolution{128, 96} : parse_resolution(o.size);
  const Camera camera = o.camera.empty() ? camera_for(box, *job.picture) : parse_camera(o.camera);
  job.rays = camera.rays(*job.picture);
}

Job prepare(const Options& o) {
  Job job;
  const auto mode = mode_named(o.mode);
  if (!mode)
    usage(fmt::format("--mode is '{}'; it must be nearest, farthest, any, all or hits", o.mode));
  job.mode = *mode;
  if (o.arithmetic != "host" && o.arithmetic != "rtl") {
    usage(fmt::format("--arith is '{}'; it must be rtl or host", o.arithmetic));
  }
  if (!(o.clock_mhz > 0 && o.clock_mhz <= 1e6)) {
    usage(fmt::format("--clock is {} MHz; it must be above 0, to 1000000", o.clock_mhz));
  }
  if (!(o.timeout > 0)) usage(fmt::format("--timeout is {} s; it must be above 0", o.timeout));
  check_outputs(std::vector<FileUse>{{"-o", o.csv},
                                     {"--image", o.depth},
                                     {"--shaded", o.shaded},
                                     {"--trace", o.trace},
                                     {"--json", o.json ? "-" : ""}},
                std::vector<FileUse>{{"MESH", o.mesh}, {"--rays", o.rays_file}});
  job.config.lanes = o.lanes;
  job.config.arithmetic = o.arithmetic == "rtl" ? Arithmetic::kRtl : Arithmetic::kHost;
  job.config.box = o.box;
  job.config.trace = !o.trace.empty();
  if (job.config.trace && o.boards > 1) usage("--trace follows one card; leave out --boards");
  (void)job.config.parameters();  // complains about values before anything slow
  if ((!o.depth.empty() || !o.shaded.empty()) && job.mode != Mode::kNearest) {
    usage("a picture needs --mode nearest");
  }
  job.mesh = load_mesh_or_builtin(o.mesh);
  if (const auto why = out_of_range(job.mesh, o.mesh)) say("cde: warning: {}\n", *why);
  collect_rays(o, job);
  if ((!o.depth.empty() || !o.shaded.empty()) && !job.picture)
    usage("a picture needs --camera or --grid");
  if (job.mesh.faces.size() > job.config.ddr_slots) {
    throw Error(ErrorCode::kCapacity,
                fmt::format("{}: {} triangles do not fit the card's DDR, which holds {}", o.mesh,
                            job.mesh.faces.size(), job.config.ddr_slots));
  }
  return job;
}

/// Rows of hits.csv.
class Csv {
 public:
  Csv(const std::string& path, bool bits) : file_(path), bits_(bits) {
    file_.write("ray,F,T,CPx,CPy,CPz,index");
    if (bits_) file_.write(",T_bits,CPx_bits,CPy_bits,CPz_bits");
    file_.write("\n");
  }
  void add(std::span<const Record> records) {
    text_.clear();
    for (const Record& r : records) {
      fmt::format_to(std::back_inserter(text_), "{},{},{},{},{},{},{}", r.primary, r.f ? 1 : 0, r.t,
                     r.cp.x(), r.cp.y(), r.cp.z(), r.index);
      if (bits_) {
        for (const float x : {r.t, r.cp.x(), r.cp.y(), r.cp.z()}) {
          fmt::format_to(std::back_inserter(text_), ",{:08x}", std::bit_cast<std::uint32_t>(x));
        }
      }
      text_.push_back('\n');
    }
    file_.write({text_.data(), text_.size()});
  }
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  bool bits_;
  fmt::memory_buffer text_;
};

/// Waves are kept whatever comes of the cast, if they are whole: they are wanted most when it
/// fails.
class Waves {
 public:
  Waves(Board& board, const std::string& path) : board_(board), path_(path) {
    if (path.empty()) return;
    file_.emplace(path, OutputFile::Use::kByName);
    board.trace_open(file_->temporary());
  }
  ~Waves() {
    try {
      close();
    } catch (const Error& e) {
      say("cde: {}\n", e.what());
    }
  }
  /// Error kFile if they are not whole; then nothing of them is left.
  void close() {
    if (!file_) return;
    try {
      board_.trace_close();
      file_->commit();
      file_.reset();
    } catch (const Error& e) {
      file_.reset();
      throw Error(ErrorCode::kFile, fmt::format("{}: {}", path_, e.what()));
    }
  }
  Waves(const Waves&) = delete;
  Waves& operator=(const Waves&) = delete;

 private:
  Board& board_;
  std::string path_;
  std::optional<OutputFile> file_;
};

/// These rays on a card of their own; `take` gets the checked records in order.
Outcome cast_on_card(const Options& o, const Job& job, std::span<const Ray> rays,
                     const std::function<void(double)>& progress, const RecordSink& take) {
  Board board = Board::open(
      job.config,
      {.clock_period_ps = static_cast<std::uint32_t>(std::max(1.0, 1e6 / o.clock_mhz))});
  board.upload(job.mesh, false);  // load_mesh has checked it
  const std::string command =
      fmt::format("cde cast {} --mode {} --lanes {} --arith {}{}", shell_word(o.mesh), o.mode,
                  o.lanes, o.arithmetic, o.box ? "" : " --no-box");
  std::optional<reference::Checker> checker;
  if (o.check)
    checker.emplace(rays, job.mesh, job.mode, Stencil(), board.primaries(), command,
                    std::span<const Object>(), o.box);

  Outcome result;
  Waves waves(board, o.trace);
  const Query query{.mode = job.mode,
                    .deadline_clocks = o.deadline,
                    .watchdog = std::chrono::duration<double>(o.timeout),
                    .progress = progress};
  double host_seconds = 0;
  const auto start = Clock::now();
  result.counters = board.cast(rays, query, [&](std::span<const Record> records) {
    const auto received = Clock::now();
    if (checker) checker->compare(records);
    for (const Record& r : records) result.hits += r.f ? 1 : 0;
    take(records);
    host_seconds += seconds_since(received);
  });
  result.simulation_seconds = seconds_since(start) - host_seconds;
  waves.close();
  if (checker) {
    checker->compare_end();
    result.compared = checker->compared();
    result.matching = checker->matching();
    result.difference = checker->difference();
  }
  result.modelled_seconds = result.counters.modelled_seconds(o.clock_mhz * 1e6);
  result.upload_clocks = board.upload_clocks();
  result.bitstream = board.bitstream().string();
  result.config_hash = board.config_hash();
  return result;
}

/// Whole packets of the rays shared out over `o.boards` cards, each in a thread; records in the
/// order of one card.
Outcome cast_on_cards(const Options& o, const Job& job, const std::function<void(double)>& progress,
                      const RecordSink& take) {
  constexpr std::size_t kPacket = 256;
  const std::size_t packets = (job.rays.size() + kPacket - 1) / kPacket;
  struct Share {
    std::size_t first = 0, size = 0;
    std::vector<Record> records;
    std::future<Outcome> outcome;
  };
  std::vector<Share> shares(std::min<std::size_t>(o.boards, packets));
  (void)Bitstream::open(job.config.top(),
                        job.config.parameters());  // built once, before all want it
  for (std::size_t i = 0; i < shares.size(); ++i) {
    Share& share = shares[i];
    share.first = std::min(job.rays.size(), packets * i / shares.size() * kPacket);
    share.size =
        std::min(job.rays.size(), packets * (i + 1) / shares.size() * kPacket) - share.first;
    share.outcome = std::async(std::launch::async, [&, i] {
      return cast_on_card(o, job, std::span(job.rays).subspan(share.first, share.size),
                          i == 0 ? progress : std::function<void(double)>(),
                          [&share](std::span<const Record> records) {
                            share.records.insert(share.records.end(), records.begin(),
                                                 records.end());
                          });
    });
  }
  Outcome all;
  for (Share& share : shares) {
    const Outcome one = share.outcome.get();
    for (Record& r : share.records) r.primary += static_cast<std::uint32_t>(share.first);
    take(share.records);
    all.counters += one.counters;
    all.hits += one.hits;
    all.compared += one.compared;
    all.matching += one.matching;
    if (all.difference.empty()) all.difference = one.difference;
    all.upload_clocks += one.upload_clocks;
    all.modelled_seconds = std::max(all.modelled_seconds, one.modelled_seconds);
    all.simulation_seconds = std::max(all.simulation_seconds, one.simulation_seconds);
    all.bitstream = one.bitstream;
    all.config_hash = one.config_hash;
  }
  return all;
}

Outcome cast(const Options& o, const Job& job, std::optional<Csv>& csv) {
  Progress bar("casting", o.quiet);
  const auto progress = [&](double share) { bar(share); };
  std::vector<Record> pixels;
  const auto take = [&](std::span<const Record> records) {
    if (csv) csv->add(records);
    if (!o.depth.empty() || !o.shaded.empty())
      pixels.insert(pixels.end(), records.begin(), records.end());
  };
  Outcome result = o.boards > 1 ? cast_on_cards(o, job, progress, take)
                                : cast_on_card(o, job, job.rays, progress, take);
  result.pixels = std::move(pixels);
  return result;
}

void draw(const Options& o, const Job& job, const Outcome& result) {
  if (o.depth.empty() && o.shaded.empty()) return;
  std::vector<std::uint8_t> hit;
  std::vector<float> t;
  std::vector<std::uint32_t> index;
  std::vector<Eigen::Vector3f> point;
  for (const Record& r : result.pixels) {
    hit.push_back(r.f ? 1 : 0);
    t.push_back(r.t);
    index.push_back(r.index);
    point.push_back(r.cp);
  }
  const PixelHits pixels{*job.picture, job.rays, hit, t, index, point};
  if (!o.depth.empty()) write_png(depth_image(pixels), o.depth);
  if (!o.shaded.empty()) {
    ShadeOptions look;
    if (job.mesh.name != "terrain") look.palette = Palette::kClay;
    look.haze = o.grid.empty() && look.palette == Palette::kLandscape;
    write_png(shade(pixels, job.mesh, look), o.shaded);
  }
}

std::size_t packets_of(const Job& job) {
  return (job.rays.size() + 255) / 256;
}

nlohmann::ordered_json as_json(const Options& o, const Job& job, const Outcome& r) {
  const Counters& c = r.counters;
  nlohmann::ordered_json j = {
      {"mesh", o.mesh},
      {"triangles", job.mesh.faces.size()},
      {"rays", job.rays.size()},
      {"packets", packets_of(job)},
      {"mode", o.mode},
      {"boards", o.boards},
      {"lanes", o.lanes},
      {"arithmetic", o.arithmetic},
      {"format", "fp32"},
      {"algorithm", "moller"},
      {"box", o.box},
      {"bitstream", r.bitstream},
      {"config_hash", fmt::format("{:016x}", r.config_hash)},
      {"clock_hz", o.clock_mhz * 1e6},
      {"device_cycles", c.cycles},
      {"writeback_cycles", c.writeback},
      {"modelled_seconds", r.modelled_seconds},
      {"triangle_upload_clocks", r.upload_clocks},
      {"ray_upload_clocks", c.upload_clocks},
      {"total_clocks", c.total_clocks},
      {"rows", c.rows},
      {"stall_cycles", c.stalls},
      {"bubble_cycles", c.bubbles},
      {"tests", c.pairs},
      {"simulation_seconds", r.simulation_seconds},
      {"tests_per_second_simulated", static_cast<double>(c.pairs) / r.simulation_seconds},
      {"hits", r.hits},
      {"records", c.records},
      {"records_compared", r.compared},
      {"records_matching", r.matching},
      {"checked", o.check},
  };
  return j;
}

void print_summary(const Options& o, const Job& job, const Outcome& r) {
  const Counters& c = r.counters;
  const auto row = [](const char* name, const std::string& value) {
    say("{:<16} {}\n", name, value);
  };
  row("mesh", fmt::format("{}, {} triangles", o.mesh, job.mesh.faces.size()));
  row("rays", fmt::format("{} in {} packet{}", job.rays.size(), packets_of(job),
                          packets_of(job) == 1 ? "" : "s"));
  row(o.boards == 1 ? "card" : "cards",
      fmt::format("{}{} lanes, {} arithmetic, fp32, {}, mode {}",
                  o.boards == 1 ? "" : fmt::format("{} x ", o.boards), o.lanes, o.arithmetic,
                  o.box ? "box rule" : "no box rule", o.mode));
  row("device cycles", fmt::format("{} and {} of write-back, {} stalls, {} bubbles", c.cycles,
                                   c.writeback, c.stalls, c.bubbles));
  row("modelled time", fmt::format("{:.6g} ms at {:g} MHz, without bus transfers",
                                   1e3 * r.modelled_seconds, o.clock_mhz));
  row("simulation", fmt::format("{:.3g} s, {:.4g} M tests/s", r.simulation_seconds,
                                static_cast<double>(c.pairs) / r.simulation_seconds / 1e6));
  row("hits", fmt::format("{} in {} records", r.hits, c.records));
  row("check",
      o.check ? fmt::format("{} of {} records match the reference", r.matching, c.records) : "off");
}

void run(const Options& o) {
  const Job job = prepare(o);
  std::optional<Csv> csv;
  if (!o.csv.empty()) csv.emplace(o.csv, o.bits);
  const Outcome result = cast(o, job, csv);
  if (result.difference.empty()) {  // wrong records leave neither files nor pictures
    draw(o, job, result);
    if (csv) csv->commit();
  }
  if (o.json) put_json(as_json(o, job, result));
  if (!o.quiet) print_summary(o, job, result);
  if (!result.difference.empty()) throw Error(ErrorCode::kMismatch, result.difference);
}

}  // namespace

void add_cast(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "cast", "Cast rays at a mesh on the simulated card; without rays, a picture of the mesh");
  verb->add_option("mesh", o->mesh, "Mesh file, or terrain[:QX,QY,SEED]")->required();
  verb->add_option("--rays", o->rays_file,
                   "Rays from a file (- is stdin): ox,oy,oz,dx,dy,dz[,tmin[,tmax]] a line, or in "
                   "the order that a "
                   "header with these names gives");
  verb->add_option("--ray", o->rays, "One ray, same fields; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option(
      "--camera", o->camera,
      "Picture: ex,ey,ez,tx,ty,tz[,fov]: eye, target, vertical field of view in degrees");
  verb->add_option("--grid", o->grid, "Picture straight down, WxH");
  verb->add_option("--size", o->size, "Size of a --camera picture, WxH (128x96)");
  verb->add_option(
      "-o,--output", o->csv,
      "Records as CSV (- is stdout): ray,F,T,CPx,CPy,CPz,index; index is 4294967295 without a hit");
  verb->add_flag("--bits", o->bits, "CSV also shows T and CP as hexadecimal bits");
  verb->add_option("--image", o->depth, "Picture of the depths, PNG (- is stdout), near is bright");
  verb->add_option("--shaded", o->shaded, "Picture in sunlight, PNG (- is stdout)");
  verb->add_option("--mode", o->mode, "nearest, farthest, any (one record a ray), all, hits")
      ->capture_default_str();
  verb->add_option("--lanes", o->lanes, "Pairs a clock: a power of two to 256")
      ->capture_default_str();
  verb->add_option(
          "--boards", o->boards,
          "Cards that share the rays, each simulated in a thread; clocks are summed over cards")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  verb->add_option("--arith", o->arithmetic,
                   "host (the FPU, fast) or rtl (gates); same bits, same clocks")
      ->capture_default_str();
  verb->add_flag(
      "--box,!--no-box", o->box,
      "A hit must lie in the triangle's box, so that none is far from its triangle (on)");
  verb->add_flag("--json", o->json, "Summary as JSON on stdout");
  verb->add_flag("--check,!--no-check", o->check, "Compare every record with the reference (on)");
  verb->add_option("--clock", o->clock_mhz, "Core clock assumed for the modelled time, MHz")
      ->capture_default_str();
  verb->add_option("--deadline", o->deadline,
                   "Device clocks that a packet may take (0: several times what it should)")
      ->capture_default_str();
  verb->add_option("--timeout", o->timeout, "Seconds of simulation that a packet may take")
      ->capture_default_str();
  verb->add_option("--trace", o->trace,
                   "Waves of the cast, FST (- is stdout); kept even if the cast fails");
  verb->add_flag("-q,--quiet", o->quiet, "No summary and no progress");
  verb->callback([o] { run(*o); });
}

}  // namespace cde::cli
