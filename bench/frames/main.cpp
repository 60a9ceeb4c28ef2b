/// `irt render`, `irt compare`, `irt list`, `irt overhead`: the work queues inside the ray tracer.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <new>

#include "bench/frames/commands.hpp"
#include "bench/frames/usage_error.hpp"
#include "renderer/scene/scene_error.hpp"

namespace irt {
namespace {

// "300x200". Throws UsageError.
void parse_size(const std::string& text, WorkloadOptions& options) {
  std::uint64_t width = 0, height = 0;
  char rest = 0;
  // NOLINTNEXTLINE(cert-err34-c): a number that is too large is clamped, and then refused
  if (std::sscanf(text.c_str(), "%9lux%9lu%c", &width, &height, &rest) != 2) {
    throw UsageError(fmt::format("--size {}: must be a width and a height, as 300x300", text));
  }
  options.width = static_cast<std::uint32_t>(width);
  options.height = static_cast<std::uint32_t>(height);
}

void add_workload(CLI::App& command, WorkloadOptions& options, std::string& size) {
  command.add_option("--scene", options.scene, "a scene of 'irt list', or a file");
  command.add_option("--bvh", options.bvh, "acceleration structure");
  command.add_option("--frame-buffer", options.frame_buffer, "where contributions meet");
  command.add_option("--termination", options.termination, "when a thread leaves a frame");
  command.add_option("--shader", options.shader, "what light does");
  command.add_option("--task-size", options.task_size, "packets of rays per task")
      ->capture_default_str();
  command.add_option("--size", size, "picture in pixels, as 300x300")->capture_default_str();
  command.add_option("--depth", options.depth, "mirror bounces")->capture_default_str();
  command.add_flag("--pin", options.pin, "bind each thread to a core");
}

// The options that were set, by their long names with '_' for '-'.
std::vector<std::string> given(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    std::string name = option->get_single_name();
    std::ranges::replace(name, '-', '_');
    names.push_back(name == "queue" ? "queues" : name);
  }
  return names;
}

void check_range(std::string_view option, std::uint64_t value, std::uint64_t least,
                 std::uint64_t most) {
  if (value >= least && value <= most) return;
  throw UsageError(fmt::format("{} {}: must be from {} to {}", option, value, least, most));
}

int run(int argc, char** argv) {
  CLI::App app("Work queues inside a ray tracer.", "irt");
  app.require_subcommand(1);
  std::string size = "300x300";
  std::vector<std::string> plugins;
  constexpr unsigned many = 1'000'000;

  RenderOptions rendering;
  CLI::App& render_command = *app.add_subcommand("render", "render a scene with one queue");
  add_workload(render_command, rendering.workload, size);
  render_command.add_option("--queue", rendering.queue, "work queue");
  render_command.add_option("--threads", rendering.threads, "render threads (default: all)");
  render_command.add_option("--frames", rendering.frames, "frames to measure")
      ->capture_default_str();
  render_command.add_option("--warmup", rendering.warmup, "frames before that")
      ->capture_default_str();
  render_command.add_flag("--plain", rendering.plain, "leave the clocks out of the render loop");
  render_command.add_option("--image", rendering.image, "write the picture as PNG");
  render_command.add_option("--json", rendering.json, "write the figures as JSON; - for stdout");
  render_command.add_option("--csv", rendering.csv, "write the figures as CSV; - for stdout");
  render_command.add_option("--plugin", plugins, "shared object with a queue");

  CompareOptions comparing;
  CLI::App& compare_command = *app.add_subcommand("compare", "compare queues and thread counts");
  add_workload(compare_command, comparing.workload, size);
  compare_command.add_option("--queue,--queues", comparing.queues, "work queues (default: all)")
      ->delimiter(',');
  compare_command.add_option("--threads", comparing.threads, "as 1,2,4 (default: up to all)")
      ->delimiter(',');
  compare_command.add_option("--frames", comparing.frames,
                             "frames per repetition (default: by --seconds)");
  compare_command.add_option("--repetitions", comparing.repetitions, "rounds over all queues")
      ->capture_default_str();
  compare_command.add_option("--warmup", comparing.warmup, "frames before each repetition")
      ->capture_default_str();
  compare_command.add_option("--seconds", comparing.seconds, "what all should take together")
      ->capture_default_str();
  compare_command.add_option("--plugin", plugins, "shared object with a queue");
  compare_command.add_option("--out", comparing.out, "directory of the results")
      ->capture_default_str();
  compare_command.add_option("--json", comparing.json, "write the figures here, too");
  compare_command.add_flag("--resume", comparing.resume, "go on where the last run was stopped");

  CLI::App& list_command = *app.add_subcommand("list", "every choice there is");
  list_command.add_option("--plugin", plugins, "shared object with a queue");

  OverheadOptions measuring;
  CLI::App& overhead_command =
      *app.add_subcommand("overhead", "what measuring and type erasure cost");
  add_workload(overhead_command, measuring.workload, size);
  overhead_command.add_option("--threads", measuring.threads, "render threads")
      ->capture_default_str();
  overhead_command.add_option("--frames", measuring.frames, "frames of each variant")
      ->capture_default_str();
  overhead_command.add_option("--json", measuring.json, "write the figures as JSON");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }

  QueueRegistry queues;
  for (const std::string& plugin : plugins) queues.open(plugin);
  for (WorkloadOptions* workload :
       {&rendering.workload, &comparing.workload, &measuring.workload}) {
    parse_size(size, *workload);
  }
  // "--threads 0" is refused, though 0 stands for "not set" inside.
  for (CLI::App* command : {&render_command, &overhead_command}) {
    if (command->count("--threads") != 0) {
      check_range("--threads", command == &render_command ? rendering.threads : measuring.threads,
                  1, max_threads);
    }
  }
  for (const unsigned threads : comparing.threads) {
    check_range("--threads", threads, 1, max_threads);
  }
  if (render_command.parsed()) {
    check_range("--frames", rendering.frames, 1, many);
    check_range("--warmup", rendering.warmup, 0, many);
    return render(rendering, queues);
  }
  if (compare_command.parsed()) {
    if (compare_command.count("--frames") != 0) check_range("--frames", comparing.frames, 1, many);
    check_range("--repetitions", comparing.repetitions, 1, 1000);
    check_range("--warmup", comparing.warmup, 0, many);
    for (const std::string& plugin : plugins) {
      comparing.plugins.push_back(std::filesystem::absolute(plugin).string());
    }
    comparing.given = given(compare_command);
    return compare(comparing, queues);
  }
  if (overhead_command.parsed()) {
    check_range("--frames", measuring.frames, 1, many);
    return overhead(measuring);
  }
  return list(queues);
}

}  // namespace
}  // namespace irt

int main(int argc, char** argv) {
  // One line for the user, whatever it is. The three errors of the project are the user's to mend.
  try {
    return irt::run(argc, argv);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "irt: out of memory; use a smaller picture or scene\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "irt: {}\n", error.what());
  }
  return 2;
}
