// SPDX-License-Identifier: Apache-2.0
// cde plan: shows which parts of the card a scene needs, and which it leaves out.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>

#include "cde/card/json_keys.hpp"
#include "cde/scene/plan.hpp"
#include "cde/support/progress.hpp"
#include "options/device_options.hpp"
#include "options/values.hpp"
#include "output/plan_output.hpp"
#include "output/streams.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {

void add_plan(CLI::App& app) {
  struct Options {
    std::string scene, device;
    bool json = false, exact = false;
  };
  auto o = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("plan",
                                      "Print which parts of the card a scene needs, which it "
                                      "leaves out and why, and the simulation model");
  scene_option(*verb, o->scene);
  verb->add_flag("--json", o->json, "The plan as JSON on stdout");
  quiet_flag(*verb);
  scene_device_option(*verb, o->device);
  exact_card_option(*verb, o->exact);
  verb->callback([o] {
    Scene scene = read_scene(o->scene, false);
    warn(scene.warnings);
    use_device(o->device, scene);
    Plan made = plan(scene);
    scene.card.device = device_for(scene.card.device, made.board);
    if (!o->exact) use_built_card(scene, made);
    if (!o->json) return print_plan(scene, made);
    nlohmann::ordered_json j = program_json();
    j.update(plan_json(scene, made));
    print_json(j);
  });
}

}  // namespace cde::cli
