/// `irt render`, `irt compare` and so on: the work queues inside the ray tracer.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <initializer_list>
#include <list>

#include "bench/frames/commands.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::frames {
namespace {

const CLI::Range thread_range(1u, max_threads);
const CLI::Range count_range(1u, 1'000'000u);
const CLI::Range warmup_range(0u, 1'000'000u);

// "300x200". Throws UsageError.
void parse_size(const std::string& text, WorkloadOptions& options) {
  unsigned long width = 0, height = 0;
  char rest = 0;
  // NOLINTNEXTLINE(cert-err34-c): nine digits fit
  if (std::sscanf(text.c_str(), "%9lux%9lu%c", &width, &height, &rest) != 2) {
    throw UsageError(fmt::format("--size {}: must be a width and a height, as 300x300", text));
  }
  options.width = static_cast<std::uint32_t>(width);
  options.height = static_cast<std::uint32_t>(height);
}

// The options that say what is rendered and how.
//
// To `compare`, most of them can be given lists: every combination is then a workload of its own.
class WorkloadArguments {
 public:
  // A value each.
  WorkloadArguments(CLI::App& command, WorkloadOptions& options)
      : command_(command), options_(options) {}
  // Lists where `choice` is used; `workloads` has one element, and more after `expand`.
  WorkloadArguments(CLI::App& command, std::vector<WorkloadOptions>& workloads)
      : command_(command), options_(workloads.front()), workloads_(&workloads) {}

  // The choices of `tool`, but for some.
  void add(results::Tools tool, std::initializer_list<std::string_view> without = {}) {
    visit_choices([&](const Choice& choice, auto member) {
      const std::string_view key = choice.key.name;
      if (choice.option != nullptr && (results::find(key)->by & tool) != 0 &&
          std::ranges::find(without, key) == without.end()) {
        add(choice, member);
      }
    });
    command_.add_flag("--pin", options_.pin, "bind each thread to a core");
    if ((tool & results::by_pictures) == 0) return;
    command_
        .add_option_function<std::string>(
            "--size", [this](const std::string& text) { parse_size(text, options_); },
            "picture in pixels")
        ->default_str("300x300");
    depth_ = command_.get_option("--depth");
  }

  // Once the command line is read, makes every combination of the lists a workload. Throws
  // UsageError.
  void settle() const {
    expand();
    if (depth_ == nullptr || depth_->count() == 0) return;
    if (workloads_ == nullptr) return require_bounces(options_);
    for (const WorkloadOptions& workload : *workloads_) require_bounces(workload);
  }

 private:
  void expand() const {
    for (const Expansion& expansion : expansions_) {
      std::vector<WorkloadOptions> all;
      for (const WorkloadOptions& one : *workloads_) expansion(one, all);
      *workloads_ = std::move(all);
    }
  }

  // Appends `one` with each value of a list.
  using Expansion = std::function<void(const WorkloadOptions& one, std::vector<WorkloadOptions>&)>;

  template <class T>
  void add(const Choice& choice, T WorkloadOptions::*member) {
    if (workloads_ == nullptr) {
      command_.add_option(choice.option, options_.*member, choice.description)
          ->capture_default_str();
      return;
    }
    CLI::Option* option = command_.add_option_function<std::vector<T>>(
        choice.option,
        [this, member](const std::vector<T>& values) {
          expansions_.push_back([member, values](const WorkloadOptions& one, auto& all) {
            for (const T& value : values) {
              all.push_back(one);
              all.back().*member = value;
            }
          });
        },
        std::string(choice.description) + "; or a list");
    option->delimiter(',');
    if constexpr (std::is_integral_v<T>) option->default_str(std::to_string(options_.*member));
  }

  CLI::App& command_;
  WorkloadOptions& options_;
  std::vector<WorkloadOptions>* workloads_ = nullptr;
  std::vector<Expansion> expansions_;
  const CLI::Option* depth_ = nullptr;
};

// What the commands share while the command line is read.
struct Shared {
  QueueRegistry queues;
  std::list<WorkloadArguments> arguments;  // one per command
  int code = 0;                            // of the command that ran

  // The option is read before the command runs, in the order of the command line.
  void add_plugin(CLI::App& command) {
    command
        .add_option_function<std::vector<std::string>>(
            "--plugin",
            [this](const std::vector<std::string>& files) {
              for (const std::string& file : files) queues.open(file);
            },
            "shared object with a queue")
        ->trigger_on_parse();
  }
};

void add_render(CLI::App& app, Shared& shared, RenderOptions& options) {
  CLI::App& command = *app.add_subcommand("render", "render a scene with one queue");
  WorkloadArguments& workload = shared.arguments.emplace_back(command, options.workload);
  workload.add(results::by_render);
  command.add_option("--queue", options.queue, "work queue");
  command.add_option("--threads", options.threads, "render threads (default: all)")
      ->check(thread_range);
  command.add_option("--frames", options.frames, "frames to measure")
      ->capture_default_str()
      ->check(count_range);
  command.add_option("--warmup", options.warmup, "frames before that")
      ->capture_default_str()
      ->check(warmup_range);
  command.add_flag("--plain", options.plain, "leave the clocks out of the render loop");
  command.add_option("--image", options.image, "write the picture as PNG");
  command.add_option("--json", options.json, "write the figures as JSON; - for stdout");
  command.add_option("--csv", options.csv, "write the figures as CSV; - for stdout");
  command.add_option("--trace", options.trace,
                     "write what each thread did when, for ui.perfetto.dev");
  shared.add_plugin(command);
  command.final_callback([&] {
    workload.settle();
    shared.code = render(options, shared.queues);
  });
}

// The options that were set, by their long names with '_' for '-'.
std::vector<std::string> given(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    std::string name = option->get_single_name();
    std::ranges::replace(name, '-', '_');
    if (name == "queue") name = "queues";
    if (name == "width") name = "packet_width";
    names.push_back(name);
  }
  return names;
}

void add_compare(CLI::App& app, Shared& shared, CompareOptions& options) {
  CLI::App& command = *app.add_subcommand("compare", "compare queues and thread counts");
  WorkloadArguments& workload = shared.arguments.emplace_back(command, options.workloads);
  workload.add(results::by_render);
  command
      .add_option("--queue,--queues", options.queues,
                  "work queues (default: six of them, and plug-ins)")
      ->delimiter(',');
  command.add_option("--threads", options.threads, "as 1,2,4 (default: up to all)")
      ->delimiter(',')
      ->check(thread_range);
  command.add_option("--frames", options.frames, "frames per repetition (default: by --seconds)")
      ->check(count_range);
  command.add_option("--repetitions", options.repetitions, "rounds over all queues")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command.add_option("--warmup", options.warmup, "frames before each repetition")
      ->capture_default_str()
      ->check(warmup_range);
  command.add_option("--seconds", options.seconds, "what all should take together")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      .add_option("--patience", options.patience,
                  "seconds over ten times the expected until a queue counts as hung")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1e6));
  shared.add_plugin(command);
  command.add_option("--out", options.out, "directory of the results")->capture_default_str();
  command.add_option("--json", options.json, "write the figures here, too");
  command.add_flag("--resume", options.resume, "go on where the last run was stopped");
  command
      .add_option_function<std::string>(
          "--shard", [&](const std::string& text) { options.shard = parse_shard(text); },
          "measure part i of n, as 0/4; the parts need directories of their own")
      ->default_str("0/1");
  command.final_callback([&] {
    if (const CLI::Option* plugin = command.get_option("--plugin"); plugin->count() != 0) {
      for (const std::string& file : plugin->results()) {
        options.plugins.push_back(std::filesystem::absolute(file).string());
      }
    }
    workload.settle();
    options.given = given(command);
    shared.code = compare(options, shared.queues);
  });
}

void add_list(CLI::App& app, Shared& shared) {
  CLI::App& command = *app.add_subcommand("list", "every choice there is");
  shared.add_plugin(command);
  command.final_callback([&] { shared.code = list(shared.queues); });
}

void add_collide(CLI::App& app, Shared& shared, CollideOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "collide", "another application of the engine: particles that run into a scene");
  WorkloadArguments& workload = shared.arguments.emplace_back(command, options.workload);
  workload.add(results::by_collide);
  command.add_option("--queue", options.queue, "work queue");
  command.add_option("--threads", options.threads, "threads (default: all)")->check(thread_range);
  command.add_option("--particles", options.particles, "how many fly about")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000'000));
  command.add_option("--frames", options.frames, "frames to measure")
      ->capture_default_str()
      ->check(count_range);
  command.add_option("--json", options.json, "write the figures as JSON");
  shared.add_plugin(command);
  command.final_callback([&] { shared.code = collide(options, shared.queues); });
}

void add_overhead(CLI::App& app, Shared& shared, OverheadOptions& options) {
  CLI::App& command = *app.add_subcommand("overhead", "what measuring and type erasure cost");
  WorkloadArguments& workload = shared.arguments.emplace_back(command, options.workload);
  workload.add(results::by_render, {"task_system", "animate", "update"});
  command.add_option("--threads", options.threads, "render threads")
      ->capture_default_str()
      ->check(thread_range);
  command.add_option("--frames", options.frames, "frames of each variant")
      ->capture_default_str()
      ->check(count_range);
  command.add_option("--json", options.json, "write the figures as JSON");
  command.final_callback([&] {
    workload.settle();
    shared.code = overhead(options);
  });
}

int run(int argc, char** argv) {
  CLI::App app("Work queues inside a ray tracer.", "irt");
  app.require_subcommand(1);
  Shared shared;
  RenderOptions rendering;
  CompareOptions comparing;
  CollideOptions colliding;
  OverheadOptions measuring;
  add_render(app, shared, rendering);
  add_compare(app, shared, comparing);
  add_list(app, shared);
  add_collide(app, shared, colliding);
  add_overhead(app, shared, measuring);
  tell_in_one_line(app, "irt");
  if (const auto code = parse(app, argc, argv)) return *code;
  return shared.code;
}

}  // namespace
}  // namespace irt::frames

int main(int argc, char** argv) {
  return irt::run_program(
      "irt", [&] { return irt::frames::run(argc, argv); }, "a smaller picture or scene");
}
