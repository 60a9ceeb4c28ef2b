#include "stress/checker/shapes.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "stress/checker/clock.hpp"

namespace irt::checker {

namespace {

constexpr std::string_view steps = "EDRTFSWCXPLBG";

/// The parser of one text: every mistake names it.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Shape shape() {
    Shape shape;
    std::string_view rest = text_;
    if (const auto plus = rest.find('+'); plus != std::string_view::npos) {
      shape.age = number(rest.substr(plus + 1), "after '+' comes a number of pairs, at least 1");
      rest = rest.substr(0, plus);
    }
    if (const auto at = rest.find('@'); at != std::string_view::npos) {
      shape.capacity =
          number(rest.substr(at + 1), "after '@' comes a capacity in elements, at least 1");
      rest = rest.substr(0, at);
    }
    if (const auto colon = rest.find(':'); colon != std::string_view::npos) {
      shape.prologue = written_out(rest.substr(0, colon));
      rest.remove_prefix(colon + 1);
    }
    if (const auto semicolon = rest.find(';'); semicolon != std::string_view::npos) {
      shape.epilogue = written_out(rest.substr(semicolon + 1));
      rest = rest.substr(0, semicolon);
    }
    for (;;) {
      const auto bar = rest.find('|');
      shape.threads.push_back(written_out(rest.substr(0, bar)));
      if (shape.threads.back().empty()) wrong("a thread without steps");
      if (bar == std::string_view::npos) break;
      rest.remove_prefix(bar + 1);
    }
    check_end(shape);
    if (shape.threads.size() + 1 > max_threads)
      wrong("at most " + std::to_string(max_threads - 1) + " threads");
    return shape;
  }

 private:
  [[noreturn]] void wrong(const std::string& what) const {
    throw std::invalid_argument("shape \"" + std::string(text_) + "\": " + what);
  }

  [[nodiscard]] std::uint64_t number(std::string_view digits, const char* what) const {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || value == 0) wrong(what);
    return value;
  }

  std::string written_out(std::string_view word) {
    rest_ = word;
    std::string letters = sequence(0);
    if (!rest_.empty()) wrong("a ')' without '('");
    return letters;
  }

  // Up to the end or a ')' that belongs to someone else.
  std::string sequence(unsigned depth) {
    std::string letters;
    while (!rest_.empty() && rest_.front() != ')') {
      const char letter = rest_.front();
      rest_.remove_prefix(1);
      if (letter == '(')
        letters += repeated(depth + 1);
      else if (steps.find(letter) != std::string_view::npos)
        letters += letter;
      else if (letter != ' ')
        wrong(
            std::string("'") + letter +
            "' is no step; steps are E D R T F S W C X P L B G, threads are parted by '|', a "
            "prologue ends "
            "with ':', an epilogue follows ';', a capacity '@', an age '+', and (ED)*3 is EDEDED");
      check_length(letters.size());
    }
    return letters;
  }

  std::string repeated(unsigned depth) {
    if (depth > 100) wrong("more than 100 '(' in one another");
    const std::string part = sequence(depth);
    if (rest_.empty()) wrong("a '(' without ')'");
    rest_.remove_prefix(1);
    if (rest_.empty() || (rest_.front() != '*' && rest_.front() != 'x'))
      wrong("after ')' comes how often, as in (ED)*3");
    rest_.remove_prefix(1);
    const std::size_t digits = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    const std::uint64_t times =
        number(rest_.substr(0, digits), "after ')' comes how often, at least 1, as in (ED)*3");
    rest_.remove_prefix(digits);
    check_length(part.empty() ? 0 : std::min<std::uint64_t>(times, most_steps + 1) * part.size());
    std::string letters;
    for (std::uint64_t i = 0; i < times && !part.empty(); ++i) letters += part;
    return letters;
  }

  void check_length(std::size_t length) const {
    if (length > most_steps)
      wrong("more than " + std::to_string(most_steps) +
            " steps; what comes before anything else can be an age, as in EE:D|D+65000");
  }

  void check_end(const Shape& shape) const {
    std::string others =
        shape.prologue +
        shape.epilogue.substr(0, std::max<std::size_t>(shape.epilogue.size(), 1) - 1);
    for (const std::string& thread : shape.threads) others += thread;
    if (others.find('X') != std::string::npos)
      wrong("'X', which destroys the queue as it is, comes last of all and after ';', as in E|D;X");
  }

  std::string_view text_;
  std::string_view rest_;  ///< of the word in progress
};

// A part is written once if that saves the reader the counting.
std::string folded(std::string_view word) {
  constexpr std::size_t long_enough = 9;
  std::string text;
  while (!word.empty()) {
    std::size_t length = 0;
    std::size_t period = 0;
    for (std::size_t p = 1; p <= 8 && 2 * p <= word.size(); ++p) {
      std::size_t same = p;
      while (same < word.size() && word[same] == word[same - p]) ++same;
      if (same / p * p > length) {
        length = same / p * p;
        period = p;
      }
    }
    if (length < long_enough) {
      text += word.front();
      word.remove_prefix(1);
      continue;
    }
    text += "(" + std::string(word.substr(0, period)) + ")*" + std::to_string(length / period);
    word.remove_prefix(length);
  }
  return text;
}

}  // namespace

Shape parse_shape(std::string_view text) {
  return Parser(text).shape();
}

std::string to_string(const Shape& shape) {
  std::string text = shape.prologue.empty() ? "" : folded(shape.prologue) + ":";
  for (const std::string& thread : shape.threads)
    text += (&thread == shape.threads.data() ? "" : "|") + folded(thread);
  if (!shape.epilogue.empty()) text += ";" + folded(shape.epilogue);
  if (shape.capacity != 0) text += "@" + std::to_string(shape.capacity);
  if (shape.age != 0) text += "+" + std::to_string(shape.age);
  return text;
}

bool leaves_inside(const Shape& shape) {
  return shape.epilogue.ends_with('X');
}

namespace {

/// How many elements a step takes, at most; R and what follows are not counted.
std::size_t takes(char step) {
  return step == 'D' || step == 'P' || step == 'L' ? 1 : step == 'G' ? 2 : 0;
}

std::size_t pushes_of(std::string_view word) {
  std::size_t sum = 0;
  for (const char step : word) sum += step == 'E' ? 1 : step == 'B' || step == 'R' ? 2 : 0;
  return sum;
}

std::size_t takes_of(std::string_view word) {
  std::size_t sum = 0;
  for (const char step : word) sum += takes(step);
  return sum;
}

/// What a thread does before it waits for anything.
std::string_view for_certain(const std::string& word) {
  return std::string_view(word).substr(0, word.find_first_of("PW"));
}

/// Whether the steps that come before and after the threads wait only for what is there.
bool waits_alone(const Shape& shape) {
  bool closed = false;
  std::size_t held = 0;
  for (const char step : shape.prologue) {
    closed = closed || step == 'C';
    if (step == 'P' && held == 0 && !closed) return true;
    held += pushes_of(std::string_view(&step, 1));
    held -= std::min(held, takes(step));
  }
  for (const std::string& thread : shape.threads)
    closed = closed || thread.find('C') != std::string::npos;
  const auto wait = shape.epilogue.find('P');
  return wait != std::string::npos && !closed && shape.epilogue.find('C') > wait;
}

}  // namespace

std::size_t pushes_of(const Shape& shape) {
  std::size_t sum = pushes_of(shape.prologue);
  for (const std::string& thread : shape.threads) sum += pushes_of(thread);
  return sum;
}

bool closes_for_certain(const Shape& shape) {
  return shape.prologue.find('C') != std::string::npos ||
         std::ranges::any_of(shape.threads, [](const std::string& thread) {
           return for_certain(thread).find('C') != std::string_view::npos;
         });
}

bool may_starve(const Shape& shape, const Claims& claims, std::size_t places) {
  if (waits_alone(shape)) return true;
  std::string all = shape.prologue;
  for (const std::string& thread : shape.threads) all += thread;
  if (all.find('P') == std::string::npos || closes_for_certain(shape)) return false;
  // Each finds what it pushed itself.
  if (claims.own_queues()) return true;
  // These take as they find.
  if (all.find_first_of("RTF") != std::string::npos) return true;
  if (shape.capacity != 0) places = shape.capacity;
  if (claims.bounded && places != 0 && places < pushes_of(shape)) return true;
  std::size_t pushes = pushes_of(shape.prologue);
  for (const std::string& thread : shape.threads) pushes += pushes_of(for_certain(thread));
  return pushes < takes_of(all);
}

std::size_t most_held(const Shape& shape) {
  std::size_t held = 0;
  std::size_t most = 0;
  for (const char letter : shape.prologue) {
    held += letter == 'E' ? 1 : letter == 'B' ? 2 : 0;
    most = std::max(most, held);
    held -= std::min<std::size_t>(held, takes(letter));
  }
  return most;
}

std::size_t calls_of(const Shape& shape) {
  const auto calls = [](const std::string& word) {
    return static_cast<std::size_t>(std::ranges::count_if(word, [](char step) {
      return std::string_view("SWX").find(step) == std::string_view::npos;
    }));
  };
  std::size_t sum = calls(shape.prologue) + calls(shape.epilogue);
  for (const std::string& thread : shape.threads) sum += calls(thread);
  return sum;
}

bool allows(const Claims& claims, const Shape& shape) {
  if (!claims.allows_workers(static_cast<unsigned>(shape.threads.size()))) return false;
  // Whether all that `first` does happens before what `second` does of a role: a worker may have
  // another thread act for it then.
  const auto handed_over = [&shape](std::string_view letters, const std::string& first,
                                    const std::string& second) {
    const auto signalling = std::ranges::count_if(shape.threads, [](const std::string& thread) {
      return thread.find('S') != std::string::npos;
    });
    const auto signal = first.find('S');
    const auto wait = second.find('W');
    return signalling == 1 && signal != std::string::npos && wait != std::string::npos &&
           first.find_first_of(pushing, signal) == std::string::npos &&
           first.find_first_of(popping, signal) == std::string::npos &&
           second.find_first_of(letters) > wait;
  };
  const auto one_at_a_time = [&](std::string_view letters) {
    std::vector<const std::string*> users;
    for (const std::string& thread : shape.threads)
      if (thread.find_first_of(letters) != std::string::npos) users.push_back(&thread);
    for (const std::string* a : users)
      for (const std::string* b : users)
        if (a < b && !handed_over(letters, *a, *b) && !handed_over(letters, *b, *a)) return false;
    return true;
  };
  if (claims.one_producer() && !one_at_a_time(pushing)) return false;
  return !claims.one_consumer() || one_at_a_time(popping);
}

std::string obstacle(const Methods& methods, const Shape& shape) {
  std::string all = shape.prologue + shape.epilogue;
  for (const std::string& thread : shape.threads) all += thread;
  const auto lacks = [&all](std::string_view letters, bool has, const char* method) {
    const auto step = all.find_first_of(letters);
    return has || step == std::string::npos
               ? std::string{}
               : std::string("step ") + all[step] + " calls " + method + ", which it does not have";
  };
  std::string text = lacks("PC", methods.pop_wait, "pop_wait and close");
  if (text.empty()) text = lacks("L", methods.deadline, "pop_wait with a deadline");
  if (text.empty()) text = lacks("BG", methods.bulk, "push_bulk and pop_bulk");
  return text;
}

}  // namespace irt::checker
