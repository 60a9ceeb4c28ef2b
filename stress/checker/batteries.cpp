#include "stress/checker/batteries.hpp"

#include <algorithm>
#include <bit>

#include "queues/roles.hpp"
#include "stress/checker/shapes.hpp"

namespace irt::checker {

namespace {

/// When a counter wraps that moves once for each pair, twice, or once for each round of the ring,
/// whose places may have been rounded up to a power of two.
std::vector<std::uint64_t> wraps(std::uint64_t range, std::size_t capacity) {
  std::vector<std::uint64_t> all{range / 2, range, range * capacity,
                                 range * std::bit_ceil(capacity)};
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

std::vector<std::string> fitting(const std::vector<std::string>& shapes, const Claims& claims,
                                 const Methods& methods) {
  std::vector<std::string> result;
  std::ranges::copy_if(shapes, std::back_inserter(result), [&](const std::string& text) {
    const Shape shape = parse_shape(text);
    return allows(claims, shape) && obstacle(methods, shape).empty() &&
           !may_starve(shape, claims) && (claims.bounded || shape.capacity == 0);
  });
  return result;
}

std::vector<std::string> battery(const Claims& claims, const Methods& methods) {
  // Pure consumers matter: a thread that has pushed before it pops has synchronised by that. The
  // middle ones are libvsync's for its unbounded queue; S and W stand for its message passing. The
  // long ones empty a page or a batch of retired nodes, or steal, while another thread holds on to
  // a node. Rings are filled and go round at capacities that are powers of two and that are none.
  // Those with an X are destroyed with elements inside: never popped from, full, gone round, more
  // than a block of 32, after pushes that failed, beside a pop. The last of them go round a ring of
  // many places between two looks of another thread. Then those who wait: each gets an element, or
  // the queue is closed before, while or after they do; two pushes before the first of two sleepers
  // has run; some who give up, or only look, beside some who wait. At last several at once.
  static const std::vector<std::string> all{
      "F:D@1",        "F:D@2",        "F:D@3",        "F:D@5",     "E|D",       "E:D|D",
      "ES|WD",        "E;X",          "F;X@1",        "F;X@2",     "F;X@3",     "ED|ED",
      "E|E|D",        "E|D|D",        "E|E;X",        "EE|D;X",    "F:D|E;X@3", "(E)*70:D|E;X",
      "EE|DD",        "E:R|R",        "EE:D|DD",      "EES|D|WD",  "EE:DE|D",   "EE:DD|D",
      "EE|DE;X",      "EE:D|DE;X",    "E:E|D|E",      "EE|D|D",    "EE|DD@3",   "EEE:DE|D@3",
      "EDD|E",        "EEEEE:D|E@5",  "E|E|DD",       "EEE|DD",    "EE:DD|ED",  "E|E|D@2",
      "EEEE:DDDDD|E", "EEEE:DDDD|DE", "EEEEE:DDDD|D", "EEEE|DDDD", "EDED|ED@5", "EDWD|ES@5",
      "E|P",          "C|P",          "C|P|P",        "C:L|P",     "E:P|C",     "EC|P",
      "E|L",          "C|L",          "E|C|P",        "B|D",       "B|G",       "B|P|P",
      "EP|EP",        "EC|D|P",       "BB:G|D",       "B:G|E@2",   "E|L;X",     "EC|P;X",
      "B|G;X",        "C|E",          "EE|PP",        "EE|D|P",    "EE|P|P",    "E|E|PP",
      "EC|P|P",       "EC|L|P",       "EE|L|P",       "E|E|P|C",   "EEC|P|P@1", "EE|EP|P",
      "E|E|P|P",      "EB|G|D",       "B|B|G",        "BG|BG",     "BC|P|G",    "E|E|L|P",
      "EEE|P|L|L"};
  return fitting(all, claims, methods);
}

std::vector<std::string> aged_battery(const Claims& claims, bool old) {
  std::vector<std::uint64_t> ranges{1U << 8U, 1U << 16U};
  if (old) ranges = {std::uint64_t{1} << 32U};
  std::vector<std::string> all;
  const auto add = [&](std::size_t capacity, const char* shape, const std::string& suffix) {
    std::vector<std::uint64_t> ages;
    for (const std::uint64_t range : ranges)
      for (const std::uint64_t wrap : wraps(range, old ? 1 : capacity))
        ages.push_back(wrap - (capacity + 1) / 2);
    std::ranges::sort(ages);
    for (const std::uint64_t age : ages) all.push_back(shape + suffix + "+" + std::to_string(age));
  };
  if (!claims.bounded) {
    // The wrap comes with a push of the prologue, or with one of the threads.
    for (const char* shape : {"EE:D|EE", "E:DE|DE", "EE:D|E;X"}) add(3, shape, "");
    return fitting(all, claims);
  }
  for (const std::size_t capacity : {3U, 1U, 2U, 5U}) {
    if (old && capacity != 3) continue;
    for (const char* shape : {"F:DD|EE", "E:DD|EEE", "F:D|E;X"})
      add(capacity, shape, "@" + std::to_string(capacity));
  }
  if (!old)
    for (const char* shape : {"F:D@128", "F:D@256"}) all.emplace_back(shape);
  return fitting(all, claims);
}

std::string even_shape(const Claims& claims, unsigned threads, unsigned operations) {
  const Roles roles = most_roles(claims, threads);
  Shape shape;
  for (unsigned thread = 0; thread < threads; ++thread) {
    std::string word;
    if (roles.pushes(thread)) word.append(operations, 'E');
    if (roles.pops(thread)) word.append(operations, 'D');
    if (word.empty()) return "";
    shape.threads.push_back(word);
  }
  return to_string(shape);
}

}  // namespace irt::checker
