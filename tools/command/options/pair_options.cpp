// SPDX-License-Identifier: Apache-2.0
#include "options/pair_options.hpp"

#include <CLI/CLI.hpp>

#include "cde/fp/number_text.hpp"
#include "options/help.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"

namespace cde::cli {

void add_pair_options(CLI::App& verb, PairOptions& o, bool lanes) {
  pair_value(verb.add_option("pair", o.pair,
                             "ray-triangle, sphere-sphere, obb-obb, ...; the shapes may come in "
                             "the other order, with the words in that order; box is obb")
                 ->required(),
             "PAIR");
  begin_group(verb, "Test");
  one_of(verb.add_option("--algorithm", o.algorithm, "Algorithm of ray-triangle")
             ->capture_default_str(),
         algorithm_names());
  verb.add_flag_callback(
          "--box", [&o] { o.box = true; },
          "Box rule. ray-triangle: a hit must lie in the triangle's box. Pairs of solids except "
          "sphere-sphere and pairs with cylinders or planes: the signed distance is not below the "
          "distance of the boxes")
      ->default_str("on for ray-triangle, off for others");
  verb.add_flag_callback(
      "--no-box", [&o] { o.box = false; }, "The pipe without the box rule");
  excludes(verb, "--box", {"--no-box"});
  verb.add_flag("--half-space", o.half_space,
                "Pairs with a plane: the plane bounds the solid half-space n.x <= d");
  known_words(
      verb.add_option(
              "--iterations", o.iterations,
              "Iterations of cylinder-cylinder, obb-cylinder and triangle-cylinder. M,K1,K2: M "
              "directions are sampled on a circle (4, 8 or 16), then K1 steps on a circle and K2 "
              "on a free track (0 to 64 each). N: a number of evaluations, split evenly")
          ->default_str("8,8,8"),
      {}, "M,K1,K2|N");
  begin_group(verb, "Pipe");
  one_of(verb.add_option("--format", o.format, "Number format of the words")->capture_default_str(),
         pair_formats());
  one_of(verb.add_option("--arith", o.arithmetic,
                         "host computes with this processor, fast; rtl simulates gates; same bits")
             ->capture_default_str(),
         {"host", "rtl"});
  if (lanes)
    whole_number_in(
        verb.add_option("--lanes", o.lanes,
                        "Pairs per cycle. In fp64, models with more than one lane take minutes to "
                        "build for obb-obb, triangle-aabb, triangle-obb and triangle-triangle")
            ->default_str("8, or 1 for these"),
        1, 256, "");
  one_of(verb.add_option("--sat-interval", o.sat_interval,
                         "obb-obb, triangle-aabb and triangle-obb: cycles from one row of pairs to "
                         "the next; with 3, candidate axes (SAT) share units; same bits")
             ->capture_default_str(),
         {"1", "3"});
}

void check_pair_options(const CLI::App& verb, const PairOptions& o) {
  const Pair pair = pair_in_any_order(o.pair).pair;
  struct Rule {
    const char* option;
    bool fits;
    const char* expected;
  };
  const char* const with_box =
      "expected a pair with a triangle but no cylinder, sphere-obb or obb-obb";
  for (const Rule& rule :
       {Rule{"--algorithm", pair == Pair::kRayTriangle, "expected ray-triangle"},
        Rule{"--box", has_box_rule(pair), with_box}, Rule{"--no-box", has_box_rule(pair), with_box},
        Rule{"--half-space", secondary_shape(pair) == Shape::kPlane,
             "expected a pair with a plane"},
        Rule{"--sat-interval", has_sat_interval(pair),
             "expected obb-obb, triangle-aabb or triangle-obb"},
        Rule{"--iterations", has_iterations(pair),
             "expected cylinder-cylinder, obb-cylinder or triangle-cylinder"}})
    if (!rule.fits && verb.count(rule.option) != 0)
      cannot_combine(rule.option, name(pair), rule.expected);
}

}  // namespace cde::cli
