/// One repetition, in the process that was started for it.
#pragma once

#include <functional>

#include "bench/contention/job.hpp"
#include "bench/contention/subject.hpp"

namespace irt::contention {

/// Measures `job`. Threads are started and bound beforehand, begin together and run until they have
/// been stopped; a warm-up of slices ends when their rates are steady or its time is over; then the
/// counts of all threads are read at the beginning and at the end of each of `job.turns` turns,
/// which last `job.seconds` together. The rate is what lies between, over the time that does: no
/// thread's own time comes in.
///
/// `await_turn` is called before each turn and before the end, with the threads running; meanwhile
/// the whole process may be stopped. A turn begins `job.settling_seconds` after it has returned.
///
/// Afterwards the queue is emptied and the elements are added up: what was lost or doubled makes
/// the repetition *failed*.
///
/// `on_hang` is called, with a sample that says so, when threads do not stop; it must not return.
Sample measure(const Job& job, const SubjectMaker& make, const std::function<void()>& await_turn,
               const std::function<void(const Sample&)>& on_hang);

/// When a warm-up has become steady: every thread has done something, and the standard deviation of
/// the last `steady_slices` slices is below `steady_variation` of their mean.
inline constexpr unsigned steady_slices = 5;
inline constexpr double steady_variation = 0.05;

/// Nanoseconds that stamping an operation adds to what is measured of it: the median distance of
/// two stamps with nothing between them.
double measure_clock_ns(double ticks_per_nanosecond);

}  // namespace irt::contention
