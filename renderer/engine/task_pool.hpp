/// Memory of tasks: a free list per worker, so that the queue is measured and not the allocator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "renderer/engine/task.hpp"
#include "renderer/tracing/huge_pages.hpp"

namespace irt {

/// `worker` is used by one thread at a time; `level`, `allocated` and `in_use` are single-threaded.
class TaskPool {
 public:
  TaskPool(unsigned workers, std::uint32_t rays_per_task)
      : rays_per_task_(rays_per_task), lists_(workers) {}

  /// An empty task. Throws std::bad_alloc.
  Task& acquire(unsigned worker) {
    List& list = lists_[worker];
    if (list.free.empty()) {
      list.owned.push_back(std::make_unique<Task>(rays_per_task_, list.memory));
      return *list.owned.back();
    }
    Task& task = *list.free.back();
    list.free.pop_back();
    task.rays.size = 0;
    task.rays.singly = false;
    return task;
  }

  void recycle(unsigned worker, Task& task) { lists_[worker].free.push_back(&task); }

  /// Makes the free lists equally long. Without it a worker that makes more tasks than it takes
  /// would allocate in every frame while the others hoard.
  void level() {
    std::size_t total = 0;
    for (const List& list : lists_) total += list.free.size();
    const std::size_t share = total / lists_.size();
    std::vector<Task*> surplus;
    for (List& list : lists_) {
      for (; list.free.size() > share; list.free.pop_back()) surplus.push_back(list.free.back());
    }
    for (List& list : lists_) {
      for (; list.free.size() < share; surplus.pop_back()) list.free.push_back(surplus.back());
    }
    for (std::size_t i = 0; i < surplus.size(); ++i) lists_[i].free.push_back(surplus[i]);
  }

  [[nodiscard]] std::size_t allocated() const {
    std::size_t total = 0;
    for (const List& list : lists_) total += list.owned.size();
    return total;
  }

  /// Tasks acquired and not recycled.
  [[nodiscard]] std::size_t in_use() const {
    std::size_t recycled = 0;
    for (const List& list : lists_) recycled += list.free.size();
    return allocated() - recycled;
  }

 private:
  // A worker's list shares no cache line, nor the pair of lines that is prefetched together.
  struct alignas(128) List {
    // Of the rays of `owned`. Its pieces grow from a megabyte, so that few tasks take little.
    std::pmr::monotonic_buffer_resource memory{std::size_t{1} << 20, &huge_pages()};
    std::vector<Task*> free;
    std::vector<std::unique_ptr<Task>> owned;
  };

  std::uint32_t rays_per_task_;
  std::vector<List> lists_;
};

/// Collects the tasks that an application makes; the engine then hands them to the queue.
class TaskSink {
 public:
  /// Takes memory from `worker` on, from `spread` workers in turn.
  TaskSink(TaskPool& pool, unsigned worker, unsigned spread = 1)
      : pool_(pool), worker_(worker), spread_(spread) {}

  /// A new, empty task, valid until the application returns. One that stays empty is dropped.
  Task& add(TaskKind kind, std::uint32_t depth, std::uint32_t sample = 0) {
    const auto next = static_cast<unsigned>(tasks_.size() % spread_);
    Task& task = pool_.acquire(worker_ + next);
    task.kind = kind;
    task.depth = depth;
    task.sample = sample;
    tasks_.push_back(&task);
    return task;
  }

  /// Gives empty tasks back to the pool. What is left is for the engine to queue and then clear.
  std::vector<Task*>& finish() {
    std::erase_if(tasks_, [&](Task* task) {
      if (task->rays.size != 0) return false;
      pool_.recycle(worker_, *task);
      return true;
    });
    return tasks_;
  }

  /// Gives all tasks back to the pool.
  void discard() {
    for (Task* task : tasks_) pool_.recycle(worker_, *task);
    tasks_.clear();
  }

 private:
  TaskPool& pool_;
  unsigned worker_, spread_;
  std::vector<Task*> tasks_;
};

}  // namespace irt
