/// A queue under measurement: its concrete type behind one virtual call per thread, not per
/// operation.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "bench/contention/hand.hpp"
#include "queues/plugin.hpp"

namespace irt::contention {

class Subject {
 public:
  Subject() = default;
  Subject(const Subject&) = delete;
  Subject& operator=(const Subject&) = delete;
  virtual ~Subject() = default;

  /// Does what a thread of `program` does until `Table::stop` is set.
  virtual void run(Program program, Seat& seat, bool stamped) = 0;

  /// Before and after the measurement, by one thread for any worker.
  virtual bool push(unsigned worker, std::uint64_t element) = 0;
  virtual bool pop(unsigned worker, std::uint64_t& element) = 0;

  /// `worker` leaves, by the thread that acted for it.
  virtual void leave(unsigned worker) = 0;
};

/// `second` is made for scenarios of two queues.
template <class Queue>
class SubjectOf final : public Subject {
 public:
  SubjectOf(std::unique_ptr<Queue> first, std::unique_ptr<Queue> second)
      : first_(std::move(first)), second_(std::move(second)) {}

  void run(Program program, Seat& seat, bool stamped) override {
    stamped ? run_stamped<true>(program, seat) : run_stamped<false>(program, seat);
  }
  bool push(unsigned worker, std::uint64_t element) override {
    return first_->push(worker, element);
  }
  bool pop(unsigned worker, std::uint64_t& element) override {
    return first_->pop(worker, element) || (second_ && second_->pop(worker, element));
  }
  void leave(unsigned worker) override {
    irt::leave(*first_, worker);
    if (second_) irt::leave(*second_, worker);
  }

 private:
  template <bool stamped>
  void run_stamped(Program program, Seat& seat) {
    play<Hand<Queue, stamped>>(program, *first_, second_.get(), seat);
  }

  std::unique_ptr<Queue> first_, second_;
};

/// Makes what is measured: for so many workers, with so much capacity, and with a second queue or
/// not.
using SubjectMaker =
    std::function<std::unique_ptr<Subject>(unsigned workers, std::size_t capacity, bool two)>;

template <class Queue>
SubjectMaker maker_of() {
  return [](unsigned workers, std::size_t capacity, bool two) -> std::unique_ptr<Subject> {
    return std::make_unique<SubjectOf<Queue>>(
        std::make_unique<Queue>(workers, capacity),
        two ? std::make_unique<Queue>(workers, capacity) : nullptr);
  };
}

/// What the contention module of a plug-in shows, at the C symbol `irt_contention`: plain data, of
/// which the sizes are compared before anything is called.
struct SubjectModule {
  std::uint32_t abi_version = plugin_abi_version;
  std::uint32_t seat_bytes = sizeof(Seat);
  std::uint32_t table_bytes = sizeof(Table);
  std::unique_ptr<Subject> (*make)(unsigned workers, std::size_t capacity, bool two) = nullptr;
};

template <class Queue>
constexpr SubjectModule subject_module() {
  return {.make = [](unsigned workers, std::size_t capacity, bool two) {
    return maker_of<Queue>()(workers, capacity, two);
  }};
}

}  // namespace irt::contention
