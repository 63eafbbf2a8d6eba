// SPDX-License-Identifier: Apache-2.0
// cde cast and cde render: cast rays at a mesh on the simulated card, for records or pictures.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cast/job.hpp"
#include "cde/model/model.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

void run(const CastWords& words) {
  report_builds(!words.quiet);
  const CastTask task = task_of(words);
  try {
    run_cast(task);
  } catch (const CastStopped& stopped) {
    say_stopped(task.trace.file, stopped.last);
    exit_code = 128 + Interrupts::signal();
  }
}

}  // namespace

void add_cast(CLI::App& app) {
  auto words = std::make_shared<CastWords>();
  CLI::App* verb = app.add_subcommand(
      "cast",
      "Cast rays at a mesh on the simulated card. Every record is compared with the reference");
  add_cast_options(*verb, *words);
  verb->callback([words] { run(*words); });
}

void add_render(CLI::App& app) {
  auto words = std::make_shared<CastWords>();
  CLI::App* verb = app.add_subcommand(
      "render",
      "Draw pictures of a mesh; every pixel is a ray through the simulated card. Without options "
      "the picture is NAME.render.png in this folder, and is also shown if stdout is a terminal");
  add_render_options(*verb, *words);
  verb->callback([words] { run(*words); });
}

}  // namespace cde::cli
