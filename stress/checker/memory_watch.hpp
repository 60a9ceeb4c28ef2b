/// What is wrong with an access to memory, whatever it reads: races, lifetimes, bounds.
#pragma once

#include <cstdint>

#include "stress/checker/alone.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/frames.hpp"

namespace irt::checker {

class MemoryWatch {
 public:
  MemoryWatch(ExecutionState& state, Alone& alone)
      : state_(state), alone_(alone), frames_(state.threads + 1) {}

  /// The next execution begins.
  void begin() { frames_.begin(); }

  /// The thread in progress is about to read or write.
  void touch(std::uintptr_t address, std::size_t size, bool writes, bool atomic, const void* pc);
  /// It returns from a function of a program: its stack below `frame_end` is no more.
  void leave(std::uintptr_t frame_end, const void* pc);
  /// It is about to free what begins at `address`, if that can be freed. Returns the block.
  Block& free(std::uintptr_t address, const void* pc);

 private:
  void note_touch(Cell& cell, const Touch& touch);
  void check_race(const Cell& cell, const Touch& touch);
  void check_allocation(std::uintptr_t address, const Touch& touch);
  void check_frame(std::uintptr_t address, const Touch& touch);
  [[noreturn]] void report_use_after_return(const Touch& touch, unsigned owner,
                                            const Frames::Return& over);
  [[noreturn]] void report_unusable(std::uintptr_t eight_bytes, bool writes, bool atomic,
                                    const void* pc);
  /// What another thread did there that does not happen before what the one in progress does now;
  /// null if there is nothing of that kind.
  [[nodiscard]] const Touch* unordered_touch(const Cell& cell) const;
  void check_users(const Block& block, const void* pc);
  [[nodiscard]] std::string this_actor() const;
  [[nodiscard]] Moment here(const void* pc, std::string what, std::string note = "") const;

  ExecutionState& state_;
  Alone& alone_;
  Frames frames_;
};

}  // namespace irt::checker
