// Compiled for virtual cores: every access that the compiler leaves in takes simulated time. The
// memory that threads share is laid out as in renderer/engine/; the rays of a task are left out.
#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <memory>
#include <string_view>
#include <vector>

#include "bench/many_core/renderer/replay_client.hpp"
#include "renderer/engine/render_loop.hpp"
#include "renderer/frame_buffer/frame_buffer.hpp"

namespace irt::many_core {
namespace {

struct alignas(64) Task {
  std::atomic<bool> queued{false};
};

struct alignas(128) Worker {
  std::vector<Task*> overflow;
};

// What the threads share.
struct Replay {
  explicit Replay(const ReplayPlan& what)
      : plan(what),
        tasks(what.tasks),
        workers(what.threads),
        barrier(what.threads),
        counts(what.threads) {
    for (const FrameBufferEntry& entry : frame_buffers()) {
      if (entry.name == what.frame_buffer) buffer = entry.make(what.width, what.height);
    }
  }

  // Adds the contributions of the task `number`.
  void contribute(std::uint32_t number) const;

  const ReplayPlan plan;
  std::vector<Task> tasks;
  std::vector<Worker> workers;
  std::unique_ptr<FrameBuffer> buffer;
  std::barrier<> barrier;
  TaskCounts counts;
};

void Replay::contribute(std::uint32_t number) const {
  constexpr std::uint32_t room = 256;
  std::array<std::uint32_t, room> pixels;
  static constexpr std::array<float, room> light = [] {
    std::array<float, room> all{};
    all.fill(0.25F);
    return all;
  }();
  for (std::uint32_t from = 0;;) {
    const std::uint32_t count = plan.host->pixels(number, from, pixels.data(), room);
    if (count == 0) return;
    buffer->add(count, pixels.data(), light.data(), light.data(), light.data());
    from += count;
  }
}

// A simulated thread. It is passed by value, in registers, for it is no memory of the program that
// is replayed.
class ReplayThread {
 public:
  ReplayThread(Replay& shared, unsigned me) : shared_(shared), me_(me) {}

  void work() {
    for (unsigned frame = 0; frame < shared_.plan.frames; ++frame) {
      if (me_ == 0) start_frame();
      shared_.barrier.arrive_and_wait();
      charge(Activity::generate);
      Loop::work(*this);
      shared_.barrier.arrive_and_wait();
      charge(Activity::barrier);
      if (me_ == 0) {
        shared_.plan.host->output();
        charge(Activity::output);
        shared_.plan.host->frame_done();
      }
    }
  }

 private:
  // What the loop asks for.
  using Loop = RenderLoop<ReplayThread>;
  friend Loop;
  using Task = many_core::Task;
  struct Children {
    [[nodiscard]] std::size_t size() const { return count; }
    ReplayHost& host;
    std::uint32_t parent, count;
  };
  [[nodiscard]] AnyWorkQueue<void*>& queue() const { return *shared_.plan.queue; }
  [[nodiscard]] unsigned number() const { return me_; }
  [[nodiscard]] std::vector<Task*>& overflow() const { return shared_.workers[me_].overflow; }
  [[nodiscard]] TaskCounts& counts() const { return shared_.counts; }
  [[nodiscard]] bool leaves_when_empty() const { return shared_.plan.leave_when_empty; }
  static bool tasks_are_lost() { return false; }  // the simulator ends what hangs
  Children answer(Task& task, bool first_time) const;
  void hand_on(const Children& children, const auto& put) const {
    children.host.charge(me_, Activity::shade);
    const std::uint32_t first = children.host.first_child(children.parent);
    for (std::uint32_t i = first; i < first + children.count; ++i) {
      put(shared_.tasks[i]);
      children.host.charge(me_, Activity::add);
    }
  }
  void got() const { charge(Activity::get); }
  void missed() const { charge(Activity::idle); }
  void waited() const { charge(Activity::idle); }
  static void overflowed() {}

  void charge(Activity activity) const { shared_.plan.host->charge(me_, activity); }
  // Thread 0 also does what the application's thread does in the engine.
  void start_frame() const {
    shared_.plan.host->generate();
    Loop::deal(FirstTasks{shared_}, shared_.counts, [this](std::size_t i) {
      return ReplayThread(shared_, static_cast<unsigned>(i % shared_.plan.threads));
    });
  }
  struct FirstTasks {
    [[nodiscard]] std::size_t size() const { return shared.plan.roots; }
    Task* operator[](std::size_t i) const { return &shared.tasks[i]; }
    Replay& shared;
  };

  Replay& shared_;
  unsigned me_;
};

ReplayThread::Children ReplayThread::answer(Task& task, bool /*first_time*/) const {
  const auto number = static_cast<std::uint32_t>(&task - shared_.tasks.data());
  ReplayHost& host = *shared_.plan.host;
  host.trace(number);
  host.charge(me_, Activity::trace);
  host.shade(number);
  shared_.contribute(number);
  return {.host = host, .parent = number, .count = host.children(number)};
}

}  // namespace
}  // namespace irt::many_core

void* irt_replay_make(const irt::many_core::ReplayPlan* plan) {
  return new irt::many_core::Replay(*plan);
}

void irt_replay_work(void* shared, unsigned worker) {
  auto& replay = *static_cast<irt::many_core::Replay*>(shared);
  irt::many_core::ReplayThread(replay, worker).work();
  replay.plan.queue->leave(worker);
}
