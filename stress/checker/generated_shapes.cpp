#include "stress/checker/generated_shapes.hpp"

#include <algorithm>
#include <array>

namespace irt::checker {

GeneratedShapes::GeneratedShapes(const Claims& claims, const Methods& methods, std::uint64_t seed)
    : claims_(claims), methods_(methods), random_(seed) {}

Shape GeneratedShapes::next() {
  constexpr std::uint64_t shapes_per_size = 25;
  constexpr unsigned smallest = 3;
  constexpr unsigned largest = 12;
  for (;; ++count_) {
    const auto size = static_cast<unsigned>(std::min<std::uint64_t>(
        smallest + count_ / shapes_per_size, std::uint64_t{largest} + count_ / 1000));
    // Large ones alone would leave out what two threads can do.
    Shape shape = draw(size - (size > smallest ? random_.below(size - smallest) / 2 : 0));
    if (!allows(claims_, shape) || may_starve(shape, claims_) ||
        !drawn_.insert(to_string(shape)).second)
      continue;
    ++count_;
    return shape;
  }
}

Shape GeneratedShapes::draw(unsigned steps) {
  const bool single = claims_.one_producer() && claims_.one_consumer();
  unsigned threads = single ? 2 : 2 + std::min(random_.below(3), steps - 2);
  while (threads > 2 && !claims_.allows_workers(threads)) --threads;
  pusher_ = random_.below(threads);
  popper_ = single ? 1 - pusher_ : random_.below(threads);
  Shape shape;
  // Every third has nothing inside at first.
  const unsigned before = one_in(3) ? 0 : random_.below(std::min(steps - threads, 5U) + 1);
  for (unsigned i = 0; i < before; ++i) shape.prologue += one_in(6) ? 'D' : 'E';
  std::array<unsigned, 4> lengths{1, 1, 1, 1};
  for (unsigned i = threads + before; i < steps; ++i) ++lengths.at(random_.below(threads));
  for (unsigned thread = 0; thread < threads; ++thread)
    shape.threads.push_back(word(thread, lengths.at(thread)));
  // Who has no role may get one that is handed over, below.
  std::erase(shape.threads, "");
  if (shape.threads.size() >= 2 && one_in(4)) add_signal(shape);
  if (steps >= 6 && one_in(6)) {
    std::string& again =
        shape.threads[random_.below(static_cast<std::uint32_t>(shape.threads.size()))];
    if (again.find_first_of("SW") == std::string::npos) again += again;
  }
  add_size_and_age(shape);
  add_methods(shape);
  if (one_in(4)) shape.epilogue = "X";
  return shape;
}

void GeneratedShapes::add_methods(Shape& shape) {
  if (methods_.bulk && one_in(2))
    for (std::string& word : shape.threads)
      for (char& letter : word)
        if (one_in(3)) letter = letter == 'E' ? 'B' : letter == 'D' ? 'G' : letter;
  if (!methods_.pop_wait || one_in(4)) return;
  for (std::string& word : shape.threads)
    for (char& letter : word)
      if (letter == 'D' && !one_in(3)) letter = methods_.deadline && one_in(3) ? 'L' : 'P';
  if (may_starve(shape, claims_) || one_in(4)) add_closing(shape);
}

// By somebody who does not wait before.
void GeneratedShapes::add_closing(Shape& shape) {
  std::string& word =
      shape.threads[random_.below(static_cast<std::uint32_t>(shape.threads.size()))];
  const std::size_t wait = std::min(word.find_first_of("PW"), word.size());
  word.insert(random_.below(static_cast<std::uint32_t>(wait) + 1), "C");
}

std::string GeneratedShapes::word(unsigned thread, unsigned steps) {
  const bool pushes = !claims_.one_producer() || thread == pusher_;
  const bool pops = !claims_.one_consumer() || thread == popper_;
  std::string letters;
  for (unsigned i = 0; i < steps && (pushes || pops); ++i)
    letters += !pops || (pushes && one_in(2)) ? 'E' : 'D';
  return letters;
}

// One thread signals, others wait: some go on with a role that the first has given up.
void GeneratedShapes::add_signal(Shape& shape) {
  const auto count = static_cast<std::uint32_t>(shape.threads.size());
  const unsigned first = random_.below(count);
  std::string& signalling = shape.threads[first];
  const bool hands_over = one_in(2);
  signalling.insert(hands_over ? signalling.size()
                               : 1 + random_.below(static_cast<std::uint32_t>(signalling.size())),
                    "S");
  for (unsigned thread = 0; thread < count; ++thread) {
    if (thread == first || (thread != (first + 1) % count && one_in(2))) continue;
    std::string& waiting = shape.threads[thread];
    const bool takes_over = hands_over && one_in(2);
    waiting.insert(
        takes_over ? waiting.size() : random_.below(static_cast<std::uint32_t>(waiting.size())),
        "W");
    if (takes_over) waiting += one_in(2) ? "E" : "D";
  }
}

void GeneratedShapes::add_size_and_age(Shape& shape) {
  static constexpr std::array<std::size_t, 4> capacities{1, 2, 3, 5};
  if (claims_.bounded) {
    shape.capacity = capacities.at(random_.below(capacities.size()));
    if (one_in(8)) shape.prologue = "F";
  }
  static constexpr std::array<std::uint64_t, 4> wraps{1U << 7U, 1U << 8U, 1U << 15U, 1U << 16U};
  if (one_in(10)) {
    const std::uint64_t rounds = one_in(2) ? 1 : std::max<std::uint64_t>(shape.capacity, 1);
    shape.age = wraps.at(random_.below(wraps.size())) * rounds - 1 - random_.below(4);
  }
}

}  // namespace irt::checker
