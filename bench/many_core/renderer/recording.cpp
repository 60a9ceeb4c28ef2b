#include "bench/many_core/renderer/recording.hpp"

#include <algorithm>
#include <memory>
#include <span>

#include "bench/many_core/calibration/primitives.hpp"
#include "bench/running/clocks.hpp"
#include "bench/statistics/averages.hpp"
#include "renderer/engine/trace_and_shade.hpp"
#include "renderer/tracing/stopwatch.hpp"

namespace irt::many_core {
namespace {

// Takes down where contributions go. Adding to the real one is part of the replay.
class NotedContributions final : public FrameBuffer {
 public:
  using FrameBuffer::FrameBuffer;

  void add(std::uint32_t pixel, Vec3 /*value*/) override { pixels.push_back(pixel); }
  void add(std::uint32_t count, const std::uint32_t* pixel, const float* /*red*/,
           const float* /*green*/, const float* /*blue*/) override {
    pixels.insert(pixels.end(), pixel, pixel + count);
  }
  void clear() override { pixels.clear(); }
  [[nodiscard]] Vec3 sum(std::uint32_t /*pixel*/) const override { return {}; }

  std::vector<std::uint32_t> pixels;
};

double span_ns(std::uint64_t from, std::uint64_t to) {
  const std::uint64_t nothing = ticks_of_nothing();
  return static_cast<double>(to - from > nothing ? to - from - nothing : 0) *
         nanoseconds_per_tick();
}

// For phases so long that they would lose the core on a crowded machine.
double thread_ns() {
  return 1e9 * seconds_by(CLOCK_THREAD_CPUTIME_ID);
}

// Renders one frame after the other, each into a Recording of its own.
class Recorder {
 public:
  explicit Recorder(const frames::Workload& workload)
      : workload_(workload),
        size_(workload.options().task_size),
        frame_(workload.options().width, workload.options().height),
        shader_(workload.make_shader(frame_)),
        application_(workload.scene().camera, frame_, *shader_, size_,
                     workload.options().samples_per_pixel),
        pool_(1, size_),
        answers_(size_) {}

  Recording frame(const std::atomic<bool>& cancel) {
    Recording recording;
    recording.width = workload_.options().width;
    recording.height = workload_.options().height;
    std::vector<Task*> tasks;  // by number
    const double begin = thread_ns();
    TaskSink first(pool_, 0);
    application_.start_frame(first);
    recording.generate_ns = thread_ns() - begin;
    take(first.finish(), recording, tasks);
    recording.roots = static_cast<std::uint32_t>(tasks.size());
    for (std::size_t next = 0; next < tasks.size(); ++next) {
      if (!cancel) process(next, recording, tasks);
      pool_.recycle(0, *tasks[next]);
    }
    if (cancel) return {};
    recording.pixels = frame_.pixels;
    const double done = thread_ns();
    application_.finish_frame();
    recording.output_ns = thread_ns() - done;
    return recording;
  }

 private:
  static void take(const std::vector<Task*>& made, Recording& recording,
                   std::vector<Task*>& tasks) {
    for (Task* task : made) {
      recording.tasks.push_back({.kind = task->kind, .rays = task->rays.size});
      tasks.push_back(task);
    }
  }

  void process(std::size_t number, Recording& recording, std::vector<Task*>& tasks) {
    const auto first_child = static_cast<std::uint32_t>(tasks.size());
    const auto first_pixel = static_cast<std::uint32_t>(frame_.pixels.size());
    TaskSink children(pool_, 0);
    std::uint64_t traced = 0;
    const std::uint64_t begin = ticks_now();
    trace_and_shade(*tasks[number], workload_.accelerator(), application_, answers_, children,
                    nullptr, [&] { traced = ticks_now(); });
    const std::uint64_t shaded = ticks_now();
    take(children.finish(), recording, tasks);
    RecordedTask& task = recording.tasks[number];
    task.trace_ns = static_cast<float>(span_ns(begin, traced));
    task.shade_ns = static_cast<float>(span_ns(traced, shaded));
    task.first_child = first_child;
    task.children = static_cast<std::uint32_t>(tasks.size()) - first_child;
    task.first_pixel = first_pixel;
    task.pixels = static_cast<std::uint32_t>(frame_.pixels.size()) - first_pixel;
  }

  const frames::Workload& workload_;
  std::uint32_t size_;
  NotedContributions frame_;
  std::unique_ptr<Shader> shader_;
  ImageRendering application_;
  TaskPool pool_;
  Answers answers_;
};

// The median over all frames of what `of` says of one.
template <class Of>
auto median(const std::vector<Recording>& frames, Of of) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const Recording& frame : frames) values.push_back(of(frame));
  return static_cast<decltype(of(frames.front()))>(statistics::median(std::move(values)));
}

}  // namespace

double Recording::work_ns() const {
  double sum = 0;
  for (const RecordedTask& task : tasks) sum += double{task.trace_ns} + double{task.shade_ns};
  return sum;
}

std::uint64_t Recording::rays() const {
  std::uint64_t sum = 0;
  for (const RecordedTask& task : tasks) sum += task.rays;
  return sum;
}

Recording record(const frames::Workload& workload, unsigned repetitions,
                 const std::atomic<bool>& cancel) {
  Recorder recorder(workload);
  recorder.frame(cancel);  // memory and caches warm up
  std::vector<Recording> frames;
  for (unsigned i = 0; i < repetitions && !cancel; ++i) frames.push_back(recorder.frame(cancel));
  if (cancel) return {};
  Recording result = frames.front();
  for (std::size_t i = 0; i < result.tasks.size(); ++i) {
    result.tasks[i].trace_ns = median(frames, [i](const auto& f) { return f.tasks[i].trace_ns; });
    result.tasks[i].shade_ns = median(frames, [i](const auto& f) { return f.tasks[i].shade_ns; });
  }
  result.generate_ns = median(frames, [](const Recording& f) { return f.generate_ns; });
  result.output_ns = median(frames, [](const Recording& f) { return f.output_ns; });
  std::vector<double> whole;
  whole.reserve(frames.size());
  for (const Recording& frame : frames) whole.push_back(frame.work_ns());
  const double lower = statistics::quantile(whole, 0.25);
  const double upper = statistics::quantile(whole, 0.75);
  result.spread = (upper - lower) / statistics::median(whole);
  result.repetitions = repetitions;
  result.clock_ghz = 1 / measure_cycle().median;
  return result;
}

}  // namespace irt::many_core
