// Compiled for virtual cores. The memory that threads share is laid out as in
// renderer/engine/queue_engine.hpp; the rays of a task are left out.
#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <memory>
#include <string_view>
#include <vector>

#include "bench/many_core/renderer/replay_client.hpp"
#include "renderer/frame_buffer/frame_buffer.hpp"
#include "renderer/spin_wait.hpp"

namespace irt::many_core {
namespace {

struct alignas(64) Task {
  std::atomic<bool> queued{false};
};

struct alignas(128) Worker {
  std::vector<Task*> overflow;
  alignas(64) std::atomic<bool> idle{false};
};

class Replay {
 public:
  explicit Replay(const ReplayPlan& plan)
      : plan_(plan), tasks_(plan.tasks), workers_(plan.threads), barrier_(plan.threads) {
    for (const FrameBufferEntry& entry : frame_buffers()) {
      if (entry.name == plan.frame_buffer) buffer_ = entry.make(plan.width, plan.height);
    }
  }

  void work(unsigned me) {
    for (unsigned frame = 0; frame < plan_.frames; ++frame) {
      if (me == 0) start_frame();
      barrier_.arrive_and_wait();
      plan_.host->charge(me, Account::serial);
      render(me);
      barrier_.arrive_and_wait();
      plan_.host->charge(me, Account::barrier);
      if (me == 0) {
        plan_.host->output();
        plan_.host->charge(me, Account::serial);
        plan_.host->frame_done();
      }
    }
  }

 private:
  // Thread 0 also does what the application's thread does in the engine.
  void start_frame() {
    plan_.host->generate();
    // relaxed: opened by the barrier
    outstanding_.store(plan_.roots, std::memory_order_relaxed);
    for (std::uint32_t i = 0; i < plan_.roots; ++i) put(i % plan_.threads, tasks_[i]);
  }

  void render(unsigned me) {
    SpinWait wait;
    bool missed = false;
    while (true) {
      if (Task* task = get(me)) {
        plan_.host->charge(me, Account::get);
        if (missed) {
          missed = false;
          wait.reset();
          // relaxed: nobody looks but a watch
          workers_[me].idle.store(false, std::memory_order_relaxed);
        }
        process(me, *task);
        continue;
      }
      plan_.host->charge(me, Account::idle);
      if (plan_.leave_when_empty) return;
      // relaxed: see QueueEngine::work
      if (outstanding_.load(std::memory_order_relaxed) == 0) return;
      if (!missed) {
        missed = true;
        // relaxed: nobody looks but a watch
        workers_[me].idle.store(true, std::memory_order_relaxed);
      }
      wait();
      plan_.host->charge(me, Account::idle);
    }
  }

  Task* get(unsigned me) {
    void* task = nullptr;
    if (plan_.queue->pop(me, task)) return static_cast<Task*>(task);
    std::vector<Task*>& kept = workers_[me].overflow;
    if (kept.empty()) return nullptr;
    Task* last = kept.back();
    kept.pop_back();
    return last;
  }

  void put(unsigned worker, Task& task) {
    // relaxed: published by the push
    task.queued.store(true, std::memory_order_relaxed);
    if (!plan_.queue->push(worker, &task)) workers_[worker].overflow.push_back(&task);
  }

  void process(unsigned me, Task& task) {
    // relaxed: by atomicity alone
    task.queued.exchange(false, std::memory_order_relaxed);
    const auto number = static_cast<std::uint32_t>(&task - tasks_.data());
    ReplayHost& host = *plan_.host;
    host.trace(number);
    host.charge(me, Account::trace);
    host.shade(number);
    contribute(number);
    const std::uint32_t children = host.children(number);
    if (children != 1) {
      // relaxed: see QueueEngine::work
      outstanding_.fetch_add(std::int64_t{children} - 1, std::memory_order_relaxed);
    }
    host.charge(me, Account::shade);
    const std::uint32_t first = host.first_child(number);
    for (std::uint32_t child = first; child < first + children; ++child) {
      put(me, tasks_[child]);
      host.charge(me, Account::add);
    }
  }

  void contribute(std::uint32_t number) {
    constexpr std::uint32_t room = 256;
    std::array<std::uint32_t, room> pixels;
    static constexpr std::array<float, room> light = [] {
      std::array<float, room> all{};
      all.fill(0.25F);
      return all;
    }();
    for (std::uint32_t from = 0;;) {
      const std::uint32_t count = plan_.host->pixels(number, from, pixels.data(), room);
      if (count == 0) return;
      buffer_->add(count, pixels.data(), light.data(), light.data(), light.data());
      from += count;
    }
  }

  const ReplayPlan plan_;
  std::vector<Task> tasks_;
  std::vector<Worker> workers_;
  std::unique_ptr<FrameBuffer> buffer_;
  std::barrier<> barrier_;
  // Last, so that nothing else shares its lines: the object is padded to its alignment.
  alignas(128) std::atomic<std::int64_t> outstanding_{0};
};

}  // namespace
}  // namespace irt::many_core

void* irt_replay_make(const irt::many_core::ReplayPlan* plan) {
  return new irt::many_core::Replay(*plan);
}

void irt_replay_work(void* shared, unsigned worker) {
  static_cast<irt::many_core::Replay*>(shared)->work(worker);
}
