// SPDX-License-Identifier: Apache-2.0
// cde plan: what a scene needs of the card, and what it leaves out.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "cde/scene/plan.hpp"
#include "command/values.hpp"
#include "output/busy.hpp"
#include "output/json_keys.hpp"
#include "output/streams.hpp"
#include "verbs/plan_output.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {

void add_plan(CLI::App& app) {
  struct Options {
    std::string scene;
    bool json = false, exact = false;
  };
  auto o = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "plan",
      "Print what a scene needs of the card, what it leaves out and why, and the bitstream");
  scene_option(*verb, o->scene);
  verb->add_flag("--json", o->json, "The plan as JSON on stdout");
  exact_card_option(*verb, o->exact);
  verb->callback([o] {
    const Scene scene = [&] {
      const Busy busy("loading " + o->scene);
      return load_scene(o->scene);
    }();
    Plan made = plan(scene);
    if (!o->exact) use_built_card(scene, made);
    if (!o->json) {
      print_plan(scene, made);
      return;
    }
    nlohmann::ordered_json j = program_json();
    j.update(plan_json(scene, made));
    put_json(j);
  });
}

}  // namespace cde::cli
