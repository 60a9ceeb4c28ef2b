#include "stress/checker/process.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace irt::checker {

using Meaning = Accesses::Meaning;

namespace {

// Where a thread's birth and its end are stored: addresses that no program has.
constexpr std::uintptr_t births = made_up | 0x1000U;
constexpr std::uintptr_t ends = made_up | 0x2000U;
constexpr std::uintptr_t distance = 64;

std::uintptr_t birth_of(unsigned thread) {
  return births + thread * distance;
}
std::uintptr_t end_of(unsigned thread) {
  return ends + thread * distance;
}

}  // namespace

void Process::begin() {
  std::ranges::fill(births_, Birth{});
  born_.resize(state_.program.threads.size());
  std::iota(born_.begin(), born_.end(), 0U);
}

unsigned Process::place_of_child(unsigned parent) {
  const auto first = static_cast<unsigned>(state_.program.threads.size());
  const auto [place, fresh] = places_.try_emplace({parent, births_[parent].children},
                                                  first + static_cast<unsigned>(places_.size()));
  if (place->second < state_.threads) {
    ++births_[parent].children;
    return place->second;
  }
  places_.erase(place);
  state_.conclusion.give_up(
      fmt::format("the program has more than {} threads (--threads)", state_.threads));
}

unsigned Process::begin_thread(void (*entry)(void*), void* argument, const void* pc) {
  const unsigned child = place_of_child(state_.current());
  accesses_.change({birth_of(child), 4, pc, Order::release, Order::relaxed},
                   [](Value) { return Value{1}; });
  births_[child].entry = entry;
  births_[child].argument = argument;
  state_.cores.arm(
      child, [](void* self) { static_cast<Process*>(self)->live(); }, this);
  born_.push_back(child);
  turns_.bear(child);
  return child;
}

void Process::live() {
  const unsigned thread = state_.current();
  accesses_.read(
      {birth_of(thread), 4, nullptr, Order::acquire, Order::acquire, false},
      [](Value value) { return value == 0 ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
  births_[thread].entry(births_[thread].argument);
  births_[thread].returned = true;
  accesses_.change({end_of(thread), 4, nullptr, Order::release, Order::relaxed},
                   [](Value) { return Value{1}; });
}

void Process::join(unsigned core, const void* pc) {
  turns_.mine().wait_for = "a thread that does not end";
  accesses_.read(
      {end_of(core), 4, pc, Order::acquire, Order::acquire, false},
      [](Value value) { return value == 0 ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
  turns_.mine().wait_for = Turns::Thread{}.wait_for;
}

void Process::exit(int status, const void* pc) {
  if (status != 0) {
    if (pc == nullptr)
      state_.conclusion.report(FindingKind::failure,
                               fmt::format("the program ends with status {}", status), {});
    state_.conclusion.report(FindingKind::failure,
                             fmt::format("the program ends with status {} at {{0}}", status), {pc});
  }
  turns_.end_process();
}

void Process::dismiss(const void* pc) {
  turns_.dismiss(pc);
}

bool Process::is_of_threads(std::uintptr_t address) {
  return address >= births && address < ends + max_threads * distance;
}

std::string Process::what_is(std::uintptr_t address, bool writes) {
  const auto thread_at = [&](std::uintptr_t first) { return (address - first) / distance; };
  if (address >= births && thread_at(births) < max_threads && writes)
    return fmt::format("begins thread {}", thread_at(births));
  if (address >= ends && thread_at(ends) < max_threads && !writes)
    return fmt::format("waits until thread {} has ended", thread_at(ends));
  return "";
}

}  // namespace irt::checker
