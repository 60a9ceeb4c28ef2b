/// What single operations cost on this machine, measured: what a profile is made of.
///
/// Everything is measured in short bursts. A burst in which a thread lost its core, to the system
/// or to a hypervisor, takes far longer than most; it is dropped, and counted. So the figures hold
/// on a machine that has other things to do, too.
#pragma once

#include <cstddef>
#include <vector>

namespace irt::many_core {

/// What many bursts say, in nanoseconds: the median, and the tenth and ninetieth percentile.
struct Spread {
  double median = 0, low = 0, high = 0;
  std::size_t bursts = 0, dropped = 0;
};

/// Drops what is more than twice the lower quartile. All zero for no samples.
Spread summarise(std::vector<double> samples);

/// A processor, by the system's number.
using Cpu = unsigned;

/// A cycle of the core that the calling thread happens to be on: operations that wait for each
/// other.
Spread measure_cycle();

/// One core by itself, per operation. Each binds the calling thread to `cpu`.
struct Alone {
  Spread cycle;  ///< one addition that waits for the last
  Spread load, store, rmw, plain, pause;
  Spread dram;       ///< a load of a line that was flushed; empty where that cannot be done
  Spread mutex;      ///< locking and unlocking std::mutex
  Spread syscall;    ///< getppid
  Spread hand_over;  ///< one way between two threads on this core, each asleep till it is woken
};
Alone measure_alone(Cpu cpu);

/// Two cores and a line, one way.
struct Between {
  Spread ping_pong;              ///< half of a round of compare-and-swaps, over many lines
  Spread load, fetch_add, swap;  ///< of lines that the other core has written, one after the other
};
Between measure_between(Cpu a, Cpu b);

/// A sleeping thread on `sleeper` that `waker` wakes.
struct Wake {
  Spread call;     ///< the waker's call, less one that finds nobody
  Spread latency;  ///< from the end of the call until the sleeper runs
};
Wake measure_wake(Cpu waker, Cpu sleeper);

/// Nanoseconds from one fetch-and-add of any of `cpus` on a line to the next, with some `work_ns`
/// between those of one core.
Spread measure_contended(const std::vector<Cpu>& cpus, double work_ns);

/// How many fetch-and-adds in a row one of two cores gets done on a line that both want all the
/// time; no nanoseconds.
Spread measure_run(Cpu a, Cpu b);

}  // namespace irt::many_core
