#include "stress/checker/all_clients.hpp"

#include <algorithm>
#include <set>

#include "stress/checker/shapes.hpp"

namespace irt::checker {

namespace {

using Words = std::vector<std::string>;

/// All words of `length` pushes and pops.
Words words_of(unsigned length) {
  Words words{""};
  for (unsigned i = 0; i < length; ++i) {
    Words longer;
    for (const std::string& word : words)
      for (const char letter : {'E', 'D'}) longer.push_back(word + letter);
    words = std::move(longer);
  }
  return words;
}

/// All ways to make `calls` in threads, the longest word first, so that each comes in one order.
void add_threads(unsigned calls, const Words& so_far, std::vector<Words>& result) {
  if (calls == 0) {
    result.push_back(so_far);
    return;
  }
  for (unsigned length = calls; length != 0; --length)
    for (const std::string& word : words_of(length)) {
      if (!so_far.empty() &&
          std::pair(word.size(), word) > std::pair(so_far.back().size(), so_far.back()))
        continue;
      Words more = so_far;
      more.push_back(word);
      add_threads(calls - length, more, result);
    }
}

/// `threads` with every signal of one for another.
std::vector<Words> with_signals(const Words& threads) {
  std::vector<Words> result;
  std::set<Words> known;
  for (std::size_t from = 0; from < threads.size(); ++from)
    for (std::size_t to = 0; to < threads.size(); ++to)
      for (std::size_t signal = 1; from != to && signal <= threads[from].size(); ++signal)
        for (std::size_t wait = 0; wait < threads[to].size(); ++wait) {
          Words words = threads;
          words[from].insert(signal, "S");
          words[to].insert(wait, "W");
          Words sorted = words;
          std::ranges::sort(sorted);
          if (known.insert(sorted).second) result.push_back(words);
        }
  return result;
}

}  // namespace

std::vector<std::string> all_clients(const Claims& claims, unsigned calls) {
  std::vector<std::string> result;
  const auto add = [&](const std::string& prologue, const Words& threads) {
    Shape shape{.prologue = prologue, .threads = threads, .epilogue = "", .capacity = 0, .age = 0};
    if (!allows(claims, shape)) return;
    std::size_t pushes = most_held(shape);
    for (const std::string& thread : threads)
      pushes += static_cast<std::size_t>(std::ranges::count(thread, 'E'));
    const std::size_t largest = claims.bounded ? std::max<std::size_t>(pushes, 1) : 0;
    for (shape.capacity = claims.bounded ? 1 : 0; shape.capacity <= largest; ++shape.capacity)
      for (const char* end : {"", "X"}) {
        shape.epilogue = end;
        if (pushes != 0 || shape.epilogue.empty()) result.push_back(to_string(shape));
      }
  };
  for (unsigned size = 1; size <= calls; ++size)
    for (unsigned before = 0; before < size; ++before) {
      std::vector<Words> clients;
      add_threads(size - before, {}, clients);
      for (const std::string& prologue : words_of(before))
        for (const Words& threads : clients) {
          if (threads.size() == 1 && before != 0) continue;
          add(prologue, threads);
          for (const Words& signalled : with_signals(threads)) add(prologue, signalled);
        }
    }
  return result;
}

}  // namespace irt::checker
