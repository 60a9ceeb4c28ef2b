/// Loops that wait: a thread that comes back to a load in the same state as before, having changed
/// nothing and found every line where it left it, will do so until somebody takes one of the lines.
/// It sleeps until then, and goes on at the moment when its next round would have begun.
#pragma once

#include "bench/many_core/machine/event_loop.hpp"

namespace irt::many_core {

class SpinLoops {
 public:
  explicit SpinLoops(EventLoop& loop) : loop_(loop) {}

  /// The thread is about to load; it may sleep first.
  void check(Thread& me, const virtual_cores::Access& access) {
    LoopState& loop = me.loop;
    const bool elsewhere = access.pc != loop.pc || access.address != loop.address;
    if (!elsewhere || ++loop.age >= LoopState::longest) note_round(me, access);
  }
  /// A line that the thread found where it left it.
  static void watch(Thread& me, Line& line) {
    if (me.loop.rounds != 0) note_watch(me.loop, line);
  }

 private:
  static void note_watch(LoopState& loop, Line& line);
  void note_round(Thread& me, const virtual_cores::Access& access);
  void sleep(Thread& me);

  EventLoop& loop_;
};

}  // namespace irt::many_core
