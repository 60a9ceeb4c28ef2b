#include "stress/threads/perturbation.hpp"

#include <pthread.h>
#include <sched.h>
#include <string_view>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

namespace irt::stress {
namespace {

/// The cores the process started with.
const cpu_set_t& allowed_cores() {
  static const cpu_set_t set = [] {
    cpu_set_t s;
    CPU_ZERO(&s);
    sched_getaffinity(0, sizeof s, &s);
    return s;
  }();
  return set;
}

void pin_to(std::uint64_t choice) {
  const cpu_set_t& allowed = allowed_cores();
  auto left = choice % static_cast<std::uint64_t>(CPU_COUNT(&allowed));
  for (unsigned core = 0; core < CPU_SETSIZE; ++core) {
    if (!CPU_ISSET(core, &allowed) || left-- > 0) continue;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    pthread_setaffinity_np(pthread_self(), sizeof one, &one);
    return;
  }
}

int first_nice() {
  static const int nice = getpriority(PRIO_PROCESS, 0);
  return nice;
}

/// A third of the processor time beside a thread that is as nice as at the start. Not less: on a
/// busy machine the round must go on.
constexpr int nicer = 5;

void set_nice(pid_t thread, int nice) {
  setpriority(PRIO_PROCESS, static_cast<id_t>(thread), nice);
}

}  // namespace

Perturbation Perturbation::draw(std::uint64_t seed) {
  // A third of the rounds runs undisturbed: some bugs need speed.
  if (seed % 3 == 0) return {};
  seed /= 3;
  return {.delays = (seed & 1U) != 0,
          .yields = (seed & 2U) != 0,
          .moves = (seed & 12U) == 12,
          .priorities = (seed & 48U) == 48,
          .stalls = (seed & 64U) != 0};
}

std::string Perturbation::describe() const {
  std::string text;
  const auto add = [&](bool on, std::string_view name) {
    if (!on) return;
    if (!text.empty()) text += ", ";
    text += name;
  };
  add(delays, "delays");
  add(yields, "yields");
  add(moves, "moves between cores");
  add(priorities, "priority changes");
  add(stalls, "stalls");
  return text.empty() ? "undisturbed" : text;
}

Disturber::~Disturber() {
  if (changed_) stop_disturbing(gettid());
}

void stop_disturbing(pid_t thread) {
  sched_setaffinity(thread, sizeof(cpu_set_t), &allowed_cores());
  set_nice(thread, first_nice());
}

std::uint64_t Disturber::next() {
  random_ = random_ * 6364136223846793005U + 1442695040888963407U;  // Knuth's MMIX generator
  return random_ >> 33;
}

void Disturber::edge() {
  const std::uint64_t dice = next();
  if (what_.delays && dice % 8 == 0) {
    for (std::uint64_t left = next() % 1'000; left > 0; --left) asm volatile("");
  }
  if (what_.yields && dice % 64 == 1) sched_yield();
  if (what_.moves && dice % 512 == 2) {
    changed_ = true;
    pin_to(next());
  }
  if (what_.priorities && dice % 512 == 3) {
    changed_ = true;
    set_nice(gettid(), first_nice() + (next() % 4 == 0 ? nicer : 0));
  }
}

}  // namespace irt::stress
