// SPDX-License-Identifier: Apache-2.0
#include "cast/words.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>

#include "cde/fp/number_text.hpp"
#include "cde/image/camera.hpp"
#include "cde/io/rays_csv.hpp"
#include "cde/io/record_file.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "options/distribution_options.hpp"
#include "options/help.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"

namespace cde::cli {
namespace {

void add_mesh(CLI::App& verb, CastWords& o) {
  file_value(verb.add_option("mesh", o.mesh, "Mesh file, or terrain[:QX,QY,SEED]")->required(),
             "MESH");
}

void add_listed_rays(CLI::App& verb, CastWords& o) {
  file_value(
      verb.add_option("--rays", o.rays_file,
                      "Rays from a file; - is stdin. Text: ox,oy,oz,dx,dy,dz[,tmin[,tmax]] per "
                      "line, or the order of a header with these names; commas, semicolons, tabs "
                      "or blanks separate them. NumPy array (.npy, .npz): shape (..., 6), (..., 7) "
                      "or (..., 8), or structures with o, d and optionally tmin, tmax"),
      "FILE");
  text_value(verb.add_option("--ray", o.rays, "One ray, with the same fields; repeatable")
                 ->allow_extra_args(false),
             "RAY", [](const std::string& text) {
               (void)parse_ray(text, "--ray " + printable_name(text));
             });
}

void add_pixels(CLI::App& verb, CastWords& o) {
  text_value(
      verb.add_option("--camera", o.camera,
                      "Camera of the picture, ex,ey,ez,tx,ty,tz[,fov]: eye, target, vertical field "
                      "of view in degrees, above 0 and below 180; without it, 40")
          ->default_str("a view of the whole mesh"),
      "VIEW", [](const std::string& text) { (void)parse_camera(text, "--camera"); });
  text_value(verb.add_option("--grid", o.grid, "Picture straight down, with square pixels"), "WxH",
             [](const std::string& text) { (void)parse_resolution(text, "--grid"); });
  text_value(
      verb.add_option("--size", o.size, "Size of the picture in pixels")
          ->default_str("640x480; without a BVH smaller for more triangles, at least 128x96"),
      "WxH", [](const std::string& text) { (void)parse_resolution(text, "--size"); });
  one_of(verb.add_option("--up", o.up,
                         "Axis that points up in pictures; auto is y for glTF, z for others")
             ->capture_default_str(),
         {"auto", "x", "y", "z"});
  excludes(verb, "--camera", {"--rays", "--ray"});
  excludes(verb, "--grid", {"--rays", "--ray", "--camera"});
  excludes(verb, "--size", {"--rays", "--ray", "--grid"});
  excludes(verb, "--up", {"--rays", "--ray"});
}

void add_records(CLI::App& verb, CastWords& o) {
  file_value(verb.add_option(
                 "-o,--output", o.records,
                 std::string(o.renders ? "Picture in sunlight (.png), or records" : "Records") +
                     ": ray,F,T,CPx,CPy,CPz,index as .csv (- is stdout, as CSV), .npy or .jsonl; "
                     "without a hit, index is 4294967295 (null in .jsonl). An array has the axes "
                     "of the rays if each ray has one record"),
             "FILE");
  verb.add_flag("--bits", o.bits, "Also print T and CP as hexadecimal bits in CSV");
  named(verb.add_option("--fields", o.fields,
                        "Additional columns, separated by commas, which the host computes: u and v "
                        "(barycentric), normal (of the triangle), side (1 front, -1 back), node "
                        "(of the mesh file), inside (see --inside)")
            ->delimiter(',')
            ->allow_extra_args(false),
        field_names(), "LIST", "field");
  verb.add_flag("--inside", o.inside,
                "Column inside: whether the ray starts inside the mesh, which must be closed. The "
                "host computes it (winding number)");
}

void add_pictures(CLI::App& verb, CastWords& o) {
  file_value(verb.add_option("--shaded", o.shaded, "Picture in sunlight, .png"), "FILE");
  verb.add_flag("--shadows", o.shadows,
                "With --shaded: cast a second pass from every hit to the sun, and draw shadows");
  file_value(verb.add_option(
                 "--image", o.depth,
                 "Depths: .png (16 bits, near is bright), .pfm or .npy (T; inf without a hit)"),
             "FILE");
  file_value(
      verb.add_option("--normals", o.normals, "Normals, towards the eye: .png, .pfm or .npy"),
      "FILE");
  file_value(
      verb.add_option("--indices", o.indices, "Triangle indices: .png (one colour each) or .npy"),
      "FILE");
}

void add_messages(CLI::App& verb, CastWords& o) {
  verb.add_flag("--json", o.json, "Summary as JSON on stdout");
  verb.add_flag("-q,--quiet", o.quiet, "No summary and no progress");
}

void add_mode(CLI::App& verb, CastWords& o) {
  one_of(verb.add_option("--mode", o.mode,
                         "Records to keep: one per ray (nearest, farthest or any hit), all pairs, "
                         "or all hits; occluded: only whether a ray hits anything, with a BVH")
             ->capture_default_str(),
         {"nearest", "farthest", "any", "all", "hits", "occluded"});
}

void add_card(CLI::App& verb, CastWords& o) {
  one_of(verb.add_option("--algorithm", o.algorithm, "Algorithm of the ray-triangle test")
             ->capture_default_str(),
         algorithm_names());
  one_of(verb.add_option("--format", o.format,
                         "Number format of the card; mesh and rays are rounded to it, and "
                         "coordinates outside its range are an error")
             ->capture_default_str(),
         card_formats());
  lanes_value(verb.add_option("--lanes", o.lanes,
                              "Pairs per cycle of a brute-force pass, a power of two up to 256; "
                              "auto is 64, or 16 with rtl arithmetic, waves or at most 16 rays")
                  ->capture_default_str(),
              {"auto"});
  one_of(
      verb.add_option(
              "--arith", o.arithmetic,
              "host computes with this processor, fast; rtl simulates gates; same bits and cycles")
          ->capture_default_str(),
      {"host", "rtl"});
  verb.add_flag(
          "--box,!--no-box", o.box,
          "Box rule: a hit must lie in the triangle's box, so that none is far from its triangle")
      ->default_str("on");
  verb.add_flag(
      "--bvh,!--no-bvh", o.bvh,
      "--bvh: rays traverse a BVH. --no-bvh: brute force. The records are the same. Without "
      "either, rays traverse a BVH where that is faster, from 2,048 triangles on");
  exact_card_option(verb, o.exact);
}

void add_checks(CLI::App& verb, CastWords& o) {
  begin_group(verb, "Checks and limits");
  flag_value(verb.add_flag("--check,!--no-check", o.checks,
                           "Compare every record with the reference. With a BVH, N rays of "
                           "--check=rays:N are also checked against every triangle")
                 ->default_str("on, rays:64"),
             [](const std::string& text) { (void)parse_check(text); });
  add_bundle_options(verb, o.bundle);
  deadline_options(verb, o.deadline, o.timeout, "packet");
}

/// Adds the options that share the work among cards and processes.
void add_shares(CLI::App& verb, CastWords& o) {
  begin_group(verb, "Several cards and machines");
  whole_number_in(
      verb.add_option("--boards", o.boards,
                      "Cards that share the rays, each simulated in a thread; cycles are summed")
          ->capture_default_str(),
      1, 64, "");
  whole_number_in(
      verb.add_option(
              "--partition", o.partition,
              "Split the mesh into this many parts. Each part has its own card, and one rank "
              "simulates that card. The records are the same as with one card")
          ->capture_default_str(),
      1, 1024, "");
  add_distribution_options(verb, o.distribution);
}

/// Adds the options that both verbs have after the options of rays, pictures and records.
void add_card_and_run(CLI::App& verb, CastWords& o) {
  begin_group(verb, "Card");
  add_card(verb, o);
  add_checks(verb, o);
  begin_group(verb, "Waves");
  add_trace_options(verb, o.trace,
                    "Waves of the cast, FST; kept even if the cast fails or is stopped");
  begin_group(verb, "Modelled time");
  device_options(verb, o.device);
  add_shares(verb, o);
  begin_group(verb, "Messages");
  add_messages(verb, o);
}

}  // namespace

std::uint64_t parse_check(const std::string& text) {
  constexpr std::string_view kRays = "rays:";
  const char* const end = text.data() + text.size();
  std::uint64_t rays = 0;
  if (text.starts_with(kRays)) {
    const auto [stop, error] = std::from_chars(text.data() + kRays.size(), end, rays);
    if (error == std::errc() && stop == end) return rays;
  }
  throw Error(
      ErrorCode::kUsage,
      fmt::format("--check is '{}'; it must be rays:N with a number of rays, or have no value",
                  printable_name(text)));
}

void add_cast_options(CLI::App& verb, CastWords& words) {
  add_mesh(verb, words);
  begin_group(verb, "Rays");
  add_listed_rays(verb, words);
  add_pixels(verb, words);
  begin_group(verb, "Records");
  add_records(verb, words);
  add_mode(verb, words);
  add_card_and_run(verb, words);
}

void add_render_options(CLI::App& verb, CastWords& words) {
  words.renders = true;
  add_mesh(verb, words);
  begin_group(verb, "View");
  add_pixels(verb, words);
  begin_group(verb, "Pictures");
  add_pictures(verb, words);
  begin_group(verb, "Records");
  add_records(verb, words);
  add_card_and_run(verb, words);
}

}  // namespace cde::cli
